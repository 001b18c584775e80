#include <CLI/CLI.hpp>
#include <ctime>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/ring_access.h"
#include "app/ringctl/ring_folder.h"
#include "cli/values.h"
#include "live/promise_watch.h"
#include "process/signal_wait.h"

namespace limb_ring::ringctl {

namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

struct WatchOptions {
  std::string ring;
  double lasts_s = 0;
  bool json = false;
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

void print_breach(const RingAccess& ring, const promises::Breach& breach, nanoseconds date, bool json) {
  if (json) {
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

void print_end(const promises::JudgeCounts& counts, double seconds, bool json) {
  if (json) {
    std::cout << nlohmann::json{{"seconds", seconds},
                                {"sends", counts.sends},
                                {"packets", counts.packets},
                                {"broken", counts.breaches},
                                {"not_judged", counts.all_unjudged()},
                                {"observations_lost", counts.lost}}
                     .dump()
              << std::endl;
    return;
  }
  std::cout << "watched for " << std::fixed << std::setprecision(1) << seconds << " s: " << describe(counts) << "; "
            << (counts.breaches == 0 ? "every promise was kept" : std::to_string(counts.breaches) + " broken")
            << std::endl;
}

int run(const Context& context, const WatchOptions& options) {
  if (!options.ring.empty() && !context.ring.empty() && options.ring != context.ring)
    throw UsageError("RING and --ring name two rings");
  const RingAccess ring = RingAccess::open(choose_ring(options.ring.empty() ? context.ring : options.ring));
  live::PromiseWatch* at_work = nullptr;
  std::vector<std::uint8_t> here;
  for (const NodeName& node : ring.nodes_here()) here.push_back(node.id);
  std::uint64_t told_lost = 0;
  live::PromiseWatch watch({ring.ring(), here, ring.folds_back()}, [&](const promises::Breach& breach) {
    print_breach(ring, breach, at_work->date(breach.at_ns), options.json);
  });
  at_work = &watch;
  if (here.size() < ring.nodes().size())
    std::cerr << "ringctl: nodes of other hosts are not watched; what they send or take is not judged" << std::endl;
  const RingFolder folder(ring.ring());
  process::SignalWait signals;
  const auto began = steady_clock::now();
  const auto so_far = [&] { return std::chrono::duration<double>(steady_clock::now() - began).count(); };
  do {
    watch.poll();
    if (watch.counts().lost != told_lost)
      std::cerr << "ringctl: " << watch.counts().lost - std::exchange(told_lost, watch.counts().lost)
                << " observations came too fast; what hangs on them is not judged" << std::endl;
  } while (!folder.is_gone() && (options.lasts_s == 0 || so_far() < options.lasts_s) &&
           !signals.asked_to_end(live::PromiseWatch::kRound));
  if (folder.is_gone()) std::cerr << "ringctl: ring " << ring.ring() << " was taken down" << std::endl;
  watch.finish();
  print_end(watch.counts(), so_far(), options.json);
  return watch.counts().breaches == 0 ? kDone : kNotDone;
}

}  // namespace

void add_watch(CLI::App& app, Context& context) {
  auto options = std::make_shared<WatchOptions>();
  CLI::App* command = add_command(
      app, "watch",
      "Judge a living ring's promises until Ctrl-C or the ring is taken down: what is delivered has arrived, once "
      "and in order, every send has one result, pins are pulled once, nothing circles; a "
      "line for each one that is broken, and then exit code 1");
  command->add_option("RING", options->ring, "Its name; default: the only one running");
  command->add_option("--for", options->lasts_s, "End after so many seconds; default: never")
      ->transform(cli::seconds(0.1, 1e9));
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
