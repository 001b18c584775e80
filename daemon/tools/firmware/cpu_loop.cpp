#include "tools/firmware/cpu_loop.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include <unistd.h>

#include "tools/firmware/command_log.h"
#include "tools/firmware/stop_signal.h"

namespace limb_ring::firmware {
namespace {

using std::chrono::milliseconds;

constexpr int kMessagesPerTurn = 64;  // then the joints are due again, however many wait
constexpr milliseconds kSignalSeen{100};
/// What comes in while a sample is due so soon is taken with it, as by a control loop, which reads its commands once in
/// a period. At 1 kHz a wake-up of its own for each command costs as much as all the rest.
constexpr milliseconds kControlPeriod{1};

/// One run of the CPU: what a turn of the loop needs.
class Run {
 public:
  Run(HostPort& port, NodeCpu& cpu, nanoseconds alive_period, const RunOptions& options)
      : port_(port), cpu_(cpu), speak_every_(alive_period / 4) {
    if (options.hang_after) hang_at_ = port_.now() + *options.hang_after;
    if (options.endless_loop_at && !port_.in_lockstep())
      throw std::runtime_error(
          "--endless-loop-at is an instant of a virtual ring's clock (ringctl up --clock virtual)");
    if (options.endless_loop_at > port_.now()) loop_at_ = options.endless_loop_at;
    if (!options.command_log.empty()) log_.emplace(options.command_log);
  }

  int loop() {
    while (!exit_code_ && !stop_requested()) {
      cpu_.advance(read_clocks(port_));  // so that a command does not act on the time before it came
      take_messages();
      if (exit_code_) break;
      say_whether_stopped();
      cpu_.advance(read_clocks(port_));
      send();
      obey();
      if (!exit_code_) wait();
    }
    return exit_code_.value_or(0);
  }

 private:
  /// What has ended the wait, and what has come with it. Where nothing has, nothing is asked for: that is a system
  /// call.
  void take_messages() {
    for (int i = 0; i < kMessagesPerTurn && message_ && !exit_code_; ++i) {
      std::visit([this](const auto& content) { take(content); }, *message_);
      message_ = port_.receive(nanoseconds(0));
    }
  }

  void take(const Packet& packet) {
    const auto now = read_clocks(port_);
    const auto obeyed = cpu_.limb().count(Verdict::obey);
    cpu_.receive(packet, now);
    if (log_ && cpu_.limb().count(Verdict::obey) != obeyed) log_->note(cpu_.node(), packet, now);
  }
  void take(const Interrupt& interrupt) { cpu_.receive(interrupt, read_clocks(port_)); }
  void take(const Result& result) { cpu_.receive(result); }
  void take(const Disconnected& end) {
    std::fprintf(stderr, "limb_firmware %s: the daemon is gone: %s\n", port_.name().c_str(), end.reason.c_str());
    exit_code_ = 1;
  }
  void take(const Reply&) {}
  void take(const Observed&) {}
  void take(const ObservedLost&) {}
  void take(const CapturedPacket&) {}
  void take(const CaptureCounts&) {}

  /// Tells the network controller whether a stop is latched: it shows that in its status.
  void say_whether_stopped() {
    if (cpu_.limb().stopped() == said_stopped_) return;
    said_stopped_ = cpu_.limb().stopped();
    port_.request(said_stopped_ ? R"({"do": "stop_latched", "latched": true})"
                                : R"({"do": "stop_latched", "latched": false})");
  }

  void send() {
    const auto outgoing = cpu_.take_outgoing();
    for (const auto& packet : outgoing) port_.send(packet.destination, packet.data, packet.priority, packet.channel);
    const auto now = port_.now();
    if (outgoing.empty() && now >= speak_at_) port_.alive();
    if (!outgoing.empty() || now >= speak_at_) speak_at_ = now + speak_every_;
  }

  void obey() {
    if (loop_at_ && port_.now() >= *loop_at_) {
      std::fprintf(stderr, "limb_firmware %s: is caught in an endless loop on purpose (pid %d)\n", port_.name().c_str(),
                   static_cast<int>(getpid()));
      loop_endlessly();
    }
    const auto& order = cpu_.fault_command();
    const bool overdue = hang_at_ && port_.now() >= *hang_at_;
    if (overdue || (order && order->kind == FaultCommand::Kind::hang)) {
      std::fprintf(stderr, "limb_firmware %s: hangs on purpose (pid %d)\n", port_.name().c_str(),
                   static_cast<int>(getpid()));
      hang();
    }
    if (!order) return;
    std::fprintf(stderr, "limb_firmware %s: ends on purpose with code %d\n", port_.name().c_str(), order->code);
    exit_code_ = order->code;
  }

  /// A stop signal is seen kSignalSeen later at the latest.
  void wait() {
    if (message_) return;
    const nanoseconds now = port_.now();
    nanoseconds until = std::min(speak_at_, now + kSignalSeen);
    if (const auto due = cpu_.due()) until = std::min(until, *due);
    if (hang_at_) until = std::min(until, *hang_at_);
    if (loop_at_) until = std::min(until, *loop_at_);
    const nanoseconds left = std::max(until - now, nanoseconds(0));
    const bool is_short = left <= kControlPeriod && !port_.in_lockstep();
    if (is_short) std::this_thread::sleep_for(left);
    message_ = port_.receive(is_short ? nanoseconds(0) : left);
  }

  HostPort& port_;
  NodeCpu& cpu_;
  nanoseconds speak_every_;
  std::optional<nanoseconds> hang_at_;
  std::optional<nanoseconds> loop_at_;
  std::optional<CommandLog> log_;
  std::optional<int> exit_code_;
  nanoseconds speak_at_{0};
  std::optional<Message> message_;  ///< that has ended the wait
  bool said_stopped_ = false;
};

}  // namespace

Timestamps read_clocks(const HostPort& port) {
  const nanoseconds now = port.now();
  return {now, port.stamp_of(now).count()};
}

int run(HostPort& port, NodeCpu& cpu, nanoseconds alive_period, const RunOptions& options) {
  return Run(port, cpu, alive_period, options).loop();
}

}  // namespace limb_ring::firmware
