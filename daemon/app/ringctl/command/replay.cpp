#include <poll.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/common/text_table.h"
#include "app/ringctl/choose_ring.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/connect_node.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/progress.h"
#include "app/ringctl/replay_plan.h"
#include "app/ringctl/ring_access.h"
#include "app/ringctl/seen_packets.h"
#include "capture/capture_file.h"
#include "cli/values.h"
#include "config/quantity.h"
#include "process/signal_wait.h"
#include "wire/data_packet.h"

namespace limb_ring::ringctl {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kReplayTick{20};
/// Above all time-outs a send may have by default.
constexpr milliseconds kLastResults{30'000};
/// Far below what the clocks can hold, and more than anybody waits.
constexpr std::chrono::hours kLongestReplay{24 * 365};

struct ReplayOptions {
  std::string file;
  double speed = 1;
  unsigned loop = 1;
  bool no_interrupts = false, json = false;
};

/// Sends of a plan through the ports of their sources, in their time.
class Replay {
 public:
  Replay(const RingAccess& ring, const ReplayPlan& plan) : plan_(plan), progress_(ring.ring()) {
    for (const ReplaySend& send : plan.sends)
      if (ports_.count(send.source) == 0)
        ports_.emplace(send.source, ring.connect(ring.node(std::to_string(send.source)), Stay::for_long));
    for (const auto& [node, port] : ports_) waiting_.push_back({port.fd(), POLLIN, 0});
  }

  /// @return false where somebody has asked it to end. @throw HostPortError where a daemon dies, as the next one
  bool run(double speed, process::SignalWait& signals) {
    const auto begin = steady_clock::now();
    for (const ReplaySend& send : plan_.sends) {
      const auto after_ns = static_cast<double>(std::max<std::int64_t>(0, send.after_ns));  // its line was read earlier
      const std::chrono::nanoseconds after(static_cast<std::int64_t>(after_ns / speed));
      if (!wait_until(begin + after, signals)) return false;
      put(send);
    }
    return true;
  }

  void wait_for_results(process::SignalWait& signals) {
    const auto deadline = steady_clock::now() + kLastResults;
    while (ended_ < sent_ && steady_clock::now() < deadline && !asked_to_end(signals)) take_results(kReplayTick);
  }

  std::uint64_t sent() const { return sent_; }
  std::uint64_t unanswered() const { return sent_ - ended_; }
  const std::map<Outcome, std::uint64_t>& outcomes() const { return outcomes_; }
  /// Why the others were not delivered, in words; where nobody says, the outcome.
  const std::map<std::string, std::uint64_t>& reasons() const { return reasons_; }

 private:
  static bool asked_to_end(process::SignalWait& signals) {
    return process::SignalWait::asks_to_end(signals.next(milliseconds(0)));
  }

  bool wait_until(steady_clock::time_point due, process::SignalWait& signals) {
    for (;;) {
      if (asked_to_end(signals)) return false;
      const auto left = std::chrono::ceil<milliseconds>(due - steady_clock::now());
      take_results(std::clamp(left, milliseconds(0), kReplayTick));
      if (left <= milliseconds(0)) return true;
    }
  }

  void put(const ReplaySend& send) {
    HostPort& port = ports_.at(send.source);
    ++sent_;
    if (send.interrupt)
      port.interrupt(send.destination, send.last);
    else
      port.send(send.destination, send.data, wire::priority_of(send.last), wire::channel_of(send.last));
  }

  void take_results(milliseconds patience) {
    for (auto& [node, port] : ports_)
      while (const auto message = port.receive(milliseconds(0))) take(port, *message);
    progress_.tell();
    if (patience > milliseconds(0)) ::poll(waiting_.data(), waiting_.size(), static_cast<int>(patience.count()));
  }

  void take(const HostPort& port, const Message& message) {
    if (const auto* end = std::get_if<Disconnected>(&message)) throw gone(port, end->reason);
    const auto* result = std::get_if<Result>(&message);
    if (result == nullptr) return;
    ++ended_;
    ++outcomes_[result->outcome];
    if (result->outcome == Outcome::delivered) return;
    ++reasons_[result->reason.empty() ? to_string(result->outcome) : result->reason];
  }

  const ReplayPlan& plan_;
  Progress progress_;
  std::map<wire::NodeId, HostPort> ports_;
  std::vector<pollfd> waiting_;
  std::map<Outcome, std::uint64_t> outcomes_;
  std::map<std::string, std::uint64_t> reasons_;
  std::uint64_t sent_ = 0, ended_ = 0;
};

/// @throw UsageError where the last of a round would be sent more than kLongestReplay after the first
void require_an_end(const ReplayPlan& plan, const ReplayOptions& options) {
  using Days = std::chrono::duration<double, std::ratio<86400>>;
  const auto later = [](const ReplaySend& one, const ReplaySend& other) { return one.after_ns < other.after_ns; };
  const auto last = std::max_element(plan.sends.begin(), plan.sends.end(), later);
  const Days apart = std::chrono::nanoseconds(last->after_ns);
  if (apart / options.speed <= Days(kLongestReplay)) return;
  throw UsageError(options.file + ": its packets are " + app::number(apart.count()) + " days apart, which at --speed " +
                   config::format_real(options.speed) + " takes more than a year; a larger --speed is needed");
}

ReplayPlan read_plan(const ReplayOptions& options) {
  capture::CaptureFile file(options.file);
  ReplayPlan plan;
  while_telling(
      {}, [&] { plan = plan_replay(file.reader()); }, "reading " + options.file);
  tell_problems(file.reader());
  const auto unwanted = [&](const ReplaySend& send) { return options.no_interrupts && send.interrupt; };
  plan.sends.erase(std::remove_if(plan.sends.begin(), plan.sends.end(), unwanted), plan.sends.end());
  if (plan.sends.empty()) throw NotDone(options.file + ": holds nothing that can be sent again");
  require_an_end(plan, options);
  return plan;
}

nlohmann::json report_of(const Replay& replay, const ReplayPlan& plan) {
  nlohmann::json outcomes = nlohmann::json::object();
  for (const auto& [outcome, count] : replay.outcomes()) outcomes[to_string(outcome)] = count;
  return {{"sent", replay.sent()},
          {"outcomes", outcomes},
          {"reasons", replay.reasons()},
          {"unanswered", replay.unanswered()},
          {"left_out",
           {{"control", plan.control},
            {"broken", plan.broken},
            {"repeated", plan.repeated},
            {"on_other_lines", plan.elsewhere}}}};
}

void print_text(const nlohmann::json& report) {
  std::cout << "sent " << report["sent"];
  for (const auto& [outcome, count] : report["outcomes"].items()) std::cout << ", " << outcome << ' ' << count;
  if (report["unanswered"] != 0) std::cout << ", without a result " << report["unanswered"];
  for (const auto& [reason, count] : report["reasons"].items())
    if (report["outcomes"].count(reason) == 0) std::cout << "\n  " << count << ": " << reason;
  const nlohmann::json& left = report["left_out"];
  std::cout << "\nleft out of the file: " << left["control"] << " hellos and beacons, " << left["broken"] << " broken, "
            << left["repeated"] << " repeated, " << left["on_other_lines"] << " seen on other lines\n";
}

int run(const Context& context, const ReplayOptions& options) {
  const ReplayPlan plan = read_plan(options);
  const RingAccess ring = RingAccess::open(choose_ring(context.ring));
  process::SignalWait signals;
  Replay replay(ring, plan);
  std::exception_ptr daemon_gone;
  try {
    bool go_on = true;
    for (unsigned i = 0; i < options.loop && go_on; ++i) go_on = replay.run(options.speed, signals);
    replay.wait_for_results(signals);
  } catch (const HostPortError&) {
    daemon_gone = std::current_exception();
  }
  const nlohmann::json report = report_of(replay, plan);
  if (options.json)
    std::cout << report.dump(2) << '\n';
  else
    print_text(report);
  if (daemon_gone) std::rethrow_exception(daemon_gone);
  const bool all = report["outcomes"].value("delivered", std::uint64_t{0}) == plan.sends.size() * options.loop;
  return all ? kDone : kNotDone;
}

}  // namespace

void add_replay(CLI::App& app, Context& context) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = add_command(app, "replay",
                                  "Send the data packets and interrupts of a capture again, each from "
                                  "its source, in their time");
  command->add_option("FILE", options->file, "pcapng, of 'ringctl dump -w' or 'ring_sim run --capture'")->required();
  command->add_option("--speed", options->speed, "So many times as fast, 0.001 to 1000; default 1")
      ->transform(cli::real(0.001, 1000.0));
  command->add_option("--loop", options->loop, "So many times, 1 to 1000000; default 1")
      ->transform(cli::whole(1, 1000000));
  command->add_flag("--no-interrupts", options->no_interrupts, "Data packets alone: interrupts may reset CPUs again");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
