#include "tools/ringctl/traffic_again.h"

#include <poll.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <tuple>

#include "config/quantity.h"
#include "io/signal_wait.h"
#include "tools/common/command_line.h"
#include "tools/common/packet_text.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/live_dump.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"
#include "wire/packet.h"
#include "wire/packet_filter.h"
#include "wire/pcapng.h"

namespace limb_ring::ringctl {
namespace {

using capture::PacketView;

/// Where packets were seen: whether at a node's input, and the line's two nodes (from, to).
using Place = std::tuple<bool, wire::NodeId, wire::NodeId>;
/// What a retry has in common with the try before: destination and sequence number.
using Mark = std::pair<wire::NodeId, std::uint8_t>;

Place place_of(const CapturedPacket& packet) {
  return {packet.info.input, wire::NodeId{packet.info.from}, wire::NodeId{packet.info.to}};
}

class Planner {
 public:
  void read(capture::PcapngReader& reader) {
    while (auto record = reader.next())
      if (auto* packet = std::get_if<CapturedPacket>(&*record)) sort(std::move(*packet));
  }

  ReplayPlan plan() {
    for (const CapturedPacket& packet : packets_) take(packet);
    return std::move(plan_);
  }

 private:
  void sort(CapturedPacket packet) {
    const PacketView view{{}, packet.info, app::bytes_of(packet)};
    if (!view.whole() || packet.info.crc_bad) {
      ++plan_.broken;
      return;
    }
    if (kind_of(view) == capture::Kind::control) {
      ++plan_.control;
      return;
    }
    choose_place(packet);
    packets_.push_back(std::move(packet));
  }

  void choose_place(const CapturedPacket& packet) {
    const wire::NodeId source = app::fields_of(packet).source();
    const auto [place, added] = places_.emplace(source, place_of(packet));
    const bool out_of_it = packet.info.from == source, had_that = std::get<1>(place->second) == source;
    if (!added && out_of_it && !had_that) place->second = place_of(packet);
  }

  void take(const CapturedPacket& packet) {
    const wire::PacketFields fields = app::fields_of(packet);
    if (places_[fields.source()] != place_of(packet)) {
      ++plan_.elsewhere;
      return;
    }
    const Mark mark{fields.destination(), fields.code().sequence};
    const auto [last, added] = last_.emplace(std::pair{fields.source(), fields.code().interrupt}, mark);
    if (!added && packet.info.retry && last->second == mark) {
      ++plan_.repeated;
      return;
    }
    last->second = mark;
    add(packet, fields);
  }

  void add(const CapturedPacket& packet, const wire::PacketFields& fields) {
    if (plan_.sends.empty()) first_ns_ = packet.time_ns;
    const wire::ByteView data = fields.data();
    plan_.sends.push_back({packet.time_ns - first_ns_,
                           fields.source(),
                           fields.destination(),
                           fields.code().interrupt,
                           fields.last(),
                           {data.begin(), data.end()}});
  }

  std::vector<CapturedPacket> packets_;
  std::map<wire::NodeId, Place> places_;
  std::map<std::pair<wire::NodeId, bool>, Mark> last_;
  std::int64_t first_ns_ = 0;
  ReplayPlan plan_;
};

}  // namespace

ReplayPlan plan_replay(capture::PcapngReader& reader) {
  Planner planner;
  planner.read(reader);
  return planner.plan();
}

namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr milliseconds kReplayTick{20};
/// Above all time-outs a send may have by default.
constexpr milliseconds kLastResults{30'000};
/// Far below what the clocks can hold, and more than anybody waits.
constexpr std::chrono::hours kLongestReplay{24 * 365};

struct AgainOptions {
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

  /// @return false if somebody has asked it to end. @throw HostPortError if a daemon dies, as the next one
  bool run(double speed, process::SignalWait& signals) {
    const auto begin = steady_clock::now();
    standstill_ = process::Standstill(begin);
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
  /// Why the others were not delivered, in words; if nobody says, the outcome.
  const std::map<std::string, std::uint64_t>& reasons() const { return reasons_; }

 private:
  static bool asked_to_end(process::SignalWait& signals) {
    return process::SignalWait::asks_to_end(signals.next(milliseconds(0)));
  }

  bool wait_until(steady_clock::time_point due, process::SignalWait& signals) {
    for (;;) {
      if (asked_to_end(signals)) return false;
      tell_standstill(standstill_.look(steady_clock::now()));
      const auto left = std::chrono::ceil<milliseconds>(due + standstill_.total() - steady_clock::now());
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
  process::Standstill standstill_{steady_clock::now()};
  std::map<wire::NodeId, HostPort> ports_;
  std::vector<pollfd> waiting_;
  std::map<Outcome, std::uint64_t> outcomes_;
  std::map<std::string, std::uint64_t> reasons_;
  std::uint64_t sent_ = 0, ended_ = 0;
};

/// @throw UsageError if the last of a round would be sent more than kLongestReplay after the first
void require_an_end(const ReplayPlan& plan, const AgainOptions& options) {
  using Days = std::chrono::duration<double, std::ratio<86400>>;
  const auto later = [](const ReplaySend& one, const ReplaySend& other) { return one.after_ns < other.after_ns; };
  const auto last = std::max_element(plan.sends.begin(), plan.sends.end(), later);
  const Days apart = std::chrono::nanoseconds(last->after_ns);
  if (apart / options.speed <= Days(kLongestReplay)) return;
  throw UsageError(options.file + ": its packets are " + app::number(apart.count()) + " days apart, which at --speed " +
                   config::format_real(options.speed) + " takes more than a year; a larger --speed is needed");
}

ReplayPlan read_plan(const AgainOptions& options) {
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

int run(const Context& context, const AgainOptions& options) {
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

void add_traffic_again(CLI::App& app, Context& context) {
  auto options = std::make_shared<AgainOptions>();
  CLI::App* command =
      add_command(app, "again", "Send the packets of a capture again", "ringctl traffic again walk.pcapng --speed 2",
                  "Each data packet and each interrupt is sent from its source, at its time.");
  command->add_option("FILE", options->file, "pcapng, of 'ringctl traffic show -w' or 'ring_sim run --capture'")
      ->required();
  command->add_option("--speed", options->speed, "N times as fast, 0.001 to 1000; default 1")
      ->transform(cli::real(0.001, 1000.0));
  command->add_option("--loop", options->loop, "N times, 1 to 1000000; default 1")->transform(cli::whole(1, 1000000));
  command->add_flag("--no-interrupts", options->no_interrupts, "Only data packets: interrupts may reset CPUs again");
  add_json(*command, options->json);
  command->callback([&context, options] { context.action = [&context, options] { return run(context, *options); }; });
}

}  // namespace limb_ring::ringctl
