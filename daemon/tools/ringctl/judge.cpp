#include <CLI/CLI.hpp>
#include <ctime>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "io/signal_wait.h"
#include "ring/observed_daemon.h"
#include "tools/common/command_line.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/ring_folder.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

/// How often daemons are asked what is wrong, and how long all may take.
constexpr std::chrono::milliseconds kWarningLook{2000}, kWarningWait{400};

struct JudgeOptions {
  std::string ring;
  double lasts_s = 0;
  bool as_json = false;
};

/// "06:15:08.123456"; on a virtual ring seconds of its time.
std::string time_text(nanoseconds date) {
  const std::int64_t seconds = date.count() / 1'000'000'000;
  const auto us = static_cast<int>(date.count() % 1'000'000'000 / 1000);
  std::ostringstream text;
  constexpr std::int64_t kYear = 365 * 86400;
  if (seconds < kYear) {
    text << seconds;
  } else {
    const std::time_t since = seconds;
    std::tm local{};
    ::localtime_r(&since, &local);
    text << std::put_time(&local, "%H:%M:%S");
  }
  text << '.' << std::setw(6) << std::setfill('0') << us;
  return text.str();
}

std::string name_in(const RingAccess& ring, std::uint8_t id) {
  for (const NodeName& node : ring.nodes())
    if (node.id == id) return label(node);
  return std::to_string(id);
}

void print_breach(const RingAccess& ring, const promises::Breach& breach, nanoseconds date, bool as_json) {
  if (as_json) {
    std::cout << nlohmann::json{{"time_ns", date.count()},
                                {"promise", to_string(breach.promise)},
                                {"node", breach.node},
                                {"source", breach.source},
                                {"what", breach.what}}
                     .dump()
              << std::endl;
    return;
  }
  std::cout << time_text(date) << "  at node " << name_in(ring, breach.node) << ", from "
            << name_in(ring, breach.source) << ": broken: " << to_string(breach.promise) << ": " << breach.what
            << std::endl;
}

/// If something was not judged, nobody knows whether every promise was kept.
std::string verdict(const promises::JudgeCounts& counts, std::size_t unwatched) {
  if (counts.breaches != 0) return std::to_string(counts.breaches) + " broken";
  if (unwatched != 0) return app::counted(unwatched, "node") + " not watched, and not judged";
  const bool all = counts.all_unjudged() == 0 && counts.lost == 0;
  return all ? "every promise was kept" : "of what was judged, every promise was kept";
}

void print_end(const promises::JudgeCounts& counts, const std::vector<live::PromiseWatch::Unwatched>& unwatched,
               double seconds, bool as_json) {
  if (as_json) {
    nlohmann::json not_watched = nlohmann::json::array();
    for (const auto& node : unwatched) not_watched.push_back(node.node);
    std::cout << nlohmann::json{{"seconds", seconds},
                                {"sends", counts.sends},
                                {"packets", counts.packets},
                                {"broken", counts.breaches},
                                {"not_judged", counts.all_unjudged()},
                                {"not_watched", not_watched},
                                {"observations_lost", counts.lost}}
                     .dump()
              << std::endl;
    return;
  }
  std::cout << "watched for " << std::fixed << std::setprecision(1) << seconds << " s: " << describe(counts) << "; "
            << verdict(counts, unwatched.size()) << std::endl;
}

/// One run of `ringctl traffic judge`, from its start to the end of the ring or of the user's patience.
class JudgeRun {
 public:
  JudgeRun(const RingAccess& ring, const JudgeOptions& options)
      : ring_(ring),
        options_(options),
        folder_(ring.ring()),
        watch_(watched_ring(ring), [this](const promises::Breach& breach) {
          print_breach(ring_, breach, watch_.date(breach.at_ns), options_.as_json);
        }) {
    if (ring.nodes_here().size() < ring.nodes().size())
      tell_user("nodes of other hosts are not watched; what they send or take is not judged");
  }

  int run() {
    process::SignalWait signals;
    do {
      watch_.poll();
      tell_lost();
      tell_warnings();
    } while (!is_over() && !signals.asked_to_end(live::PromiseWatch::kRound));
    if (folder_.is_gone()) tell_user("ring " + ring_.ring() + " was taken down");
    watch_.finish();
    const auto unwatched = watch_.unwatched();
    for (const auto& node : unwatched) tell_user("node " + name_in(ring_, node.node) + " was not watched: " + node.why);
    print_end(watch_.counts(), unwatched, seconds(), options_.as_json);
    return watch_.counts().breaches == 0 && unwatched.empty() ? kDone : kNotDone;
  }

 private:
  static live::PromiseWatch::Ring watched_ring(const RingAccess& ring) {
    live::PromiseWatch::Ring watched{ring.ring(), {}, ring.folds_back()};
    for (const NodeName& node : ring.nodes_here()) watched.nodes.push_back(node.id);
    return watched;
  }

  double seconds() const { return std::chrono::duration<double>(steady_clock::now() - began_).count(); }
  bool is_over() const { return folder_.is_gone() || (options_.lasts_s != 0 && seconds() >= options_.lasts_s); }

  /// What the daemons find wrong with their neighbours is not a broken promise: the ring may keep them all the same.
  void tell_warnings() {
    if (steady_clock::now() < next_look_) return;
    next_look_ = steady_clock::now() + kWarningLook;
    std::set<std::pair<std::uint8_t, std::string>> now;
    const std::vector<NodeName> nodes = ring_.nodes_here();
    for (const ask::ToldRow& row : ask_for_rows(ring_.ring(), nodes, steady_clock::now() + kWarningWait)) {
      if (!row.said) continue;
      for (const status::Warning& warning : row.said->warnings) {
        const auto key = *now.emplace(row.said->id, warning.rule).first;
        if (warned_.count(key) == 0) print_warning(key.first, warning);
      }
    }
    warned_ = now;
  }

  void print_warning(std::uint8_t node, const status::Warning& warning) const {
    if (options_.as_json)
      std::cout << nlohmann::json{{"node", node}, {"rule", warning.rule}, {"warning", warning.text}}.dump()
                << std::endl;
    else
      std::cout << "warning  at node " << name_in(ring_, node) << ": " << warning.text << std::endl;
  }

  void tell_lost() {
    const std::uint64_t told = std::exchange(told_lost_, watch_.counts().lost);
    if (told_lost_ == told) return;
    tell_user(std::to_string(told_lost_ - told) + " observations came too fast; what hangs on them is not judged");
  }

  const RingAccess& ring_;
  const JudgeOptions& options_;
  const RingFolder folder_;
  live::PromiseWatch watch_;
  const steady_clock::time_point began_ = steady_clock::now();
  std::uint64_t told_lost_ = 0;
  steady_clock::time_point next_look_{};
  std::set<std::pair<std::uint8_t, std::string>> warned_;  ///< by node and rule: those of the last look
};

int run(const Context& context, const JudgeOptions& options) {
  const RingAccess ring = RingAccess::open(choose_ring(options.ring, context.ring));
  return JudgeRun(ring, options).run();
}

}  // namespace

void add_traffic_judge(CLI::App& traffic, Context& context) {
  auto options = std::make_shared<JudgeOptions>();
  CLI::App* command =
      add_command(traffic, "judge", "Judge the promises of a living ring", "ringctl traffic judge leg8 --for 60",
                  "Runs until Ctrl-C, or until the ring is taken down. The promises: a packet that is delivered has "
                  "arrived once and in order; every send has one result; a pin is pulled once; no packet circles for "
                  "ever. Prints a line for each broken promise. Exits with 1 if one was broken, or if a node could not "
                  "be watched. Also warns of neighbours that break another rule of docs/protocol.md.");
  command->add_option("RING", options->ring, "Name of the ring; default: as --ring");
  command->add_option("--for", options->lasts_s, "End after N seconds; default: never")
      ->transform(cli::seconds(0.1, 1e9));
  add_json(*command, options->as_json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
