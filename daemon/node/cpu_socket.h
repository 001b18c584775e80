#pragma once

#include "config/ring_config.h"
#include "core/time.h"
#include "node/cpu_process.h"
#include "node/cpu_status.h"
#include "node/host_server.h"
#include "node/node_driver.h"

namespace limb_ring::runtime {

/// How fast a node's CPU is given what waits for it. (ours: a CPU made slow on purpose)
class ReadThrottle {
 public:
  /// No limit: the default.
  void as_fast_as_it_can() { period_ = core::Duration{0}; }
  /// One packet per `period`, the first at once.
  void one_per(core::Duration period) { period_ = period; }
  void not_at_all() { period_ = kNeverAgain; }

  bool may_take(core::Time now) const {
    if (period_.count() == 0) return true;
    return period_ != kNeverAgain && now >= last_ + period_;
  }
  void took(core::Time now) { last_ = now; }
  /// When it may take the next one; kNever if it may at once, or never.
  core::Time next() const { return period_.count() == 0 || period_ == kNeverAgain ? core::kNever : last_ + period_; }

 private:
  static constexpr core::Duration kNeverAgain = core::Duration::max();
  core::Duration period_{0};
  core::Time last_{};
};

/// Whether what a node's CPU asks to be sent reaches the network controller. (ours: a CPU made mute on purpose)
class SendGate {
 public:
  void open() { shut_ = false; }
  /// Counts from 0.
  void shut() {
    shut_ = true;
    discarded_ = 0;
  }
  /// The CPU asks for one: whether it is discarded, and counted.
  bool discards() { return shut_ && ++discarded_ != 0; }
  std::uint64_t discarded() const { return discarded_; }

 private:
  bool shut_ = false;
  std::uint64_t discarded_ = 0;
};

/// Where the node's CPU sits: between the network controller, the host port and the process.
/// A node without a CPU has a built-in sink that reads and counts.
class CpuSocket final : private CpuEvents {
 public:
  /// `changed` is called after anything that status() shows has changed.
  CpuSocket(boost::asio::io_context& io, CpuOptions options, const config::RingConfig& ring,
            const config::NodeConfig& node, NodeDriver& driver, host::HostServer& host, std::function<void()> changed);

  void start();
  void stop(std::function<void()> done) { process_.stop(std::move(done)); }

  /// @name From the host port
  ///@{
  void greeted(pid_t pid) { process_.greeted(pid); }
  void left(pid_t pid) { process_.left(pid); }
  std::optional<std::string> attach(const host::ClientInfo& client);
  void detach(const host::ClientInfo& client);
  void spoke();
  ///@}

  /// Hands over what the receive buffers hold, by priority, as far as the CPU takes it.
  void hand_over();
  ReadThrottle& read_throttle() { return read_throttle_; }
  SendGate& send_gate() { return send_gate_; }

  /// @name Pins
  ///@{
  /// Kills and restarts the CPU, whatever state it is in; nothing stale is left for the new one.
  CpuActionResult reset(const std::string& reason);
  void interrupt(limb_ring::Interrupt::Action action, std::uint8_t source, std::uint8_t factor);
  /// Its node loses power: a child is killed and reaped at once; an attached process goes on.
  void kill() { process_.kill(); }
  CpuActionResult signal(int number) { return process_.signal(number); }
  CpuActionResult run(const std::vector<std::string>& command) { return process_.run(command); }
  const PinCommands::Counters& command_counters() const { return process_.command_counters(); }
  ///@}

  /// What is known of stop pins that were pulled.
  struct Stop {
    bool latched = false;      ///< by the CPU's own word
    bool latches = true;       ///< unless the CPU has said that it never does
    std::uint64_t pulled = 0;  ///< times since the daemon's start
    std::optional<core::Time> pulled_at;
  };
  /// What beacons tell of the CPU or of its node is another. @param change is given the report to change
  template <class Change>
  void change_report(const Change& change) {
    change(reported_);
    driver_.controller().apply(core::input::Cpu{reported_}, driver_.now());
  }
  /// The CPU says that a stop is latched, or that it has resumed. One that has just been started has nothing latched.
  void stop_latched(bool latched);
  /// The CPU says that it never latches one, so that nobody waits for its word.
  void never_latches_stops() { stop_.latches = false; }
  /// The node's clock was latched: the next beacon says so.
  void clock_latched(const wire::ClockLatch& latch);
  const Stop& stop_state() const { return stop_; }

  CpuStatus status() const;
  /// What is wrong with its firmware.
  CpuWatch& watch() { return watch_; }
  const CpuWatch& watch() const { return watch_; }

 private:
  bool is_sink() const { return kind_ == config::CpuConfig::Kind::none; }
  void on_cpu_changed() override;
  void report();
  void drop_client();
  /// What was latched, waits or is under way ends with that CPU.
  void forget(const host::ClientInfo& client);

  config::CpuConfig::Kind kind_;
  std::chrono::milliseconds alive_period_;
  NodeDriver& driver_;
  host::HostServer& host_;
  std::function<void()> changed_;
  std::string log_prefix_;
  CpuWatch watch_;
  CpuProcess process_;
  ReadThrottle read_throttle_;
  SendGate send_gate_;
  std::unique_ptr<event_loop::Timer> next_read_;
  core::CpuReport reported_;
  Stop stop_;
  std::uint32_t sink_boots_ = 1;
  std::uint64_t sink_resets_ = 0;
};

}  // namespace limb_ring::runtime
