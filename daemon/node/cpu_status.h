#pragma once

#include <sys/types.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "core/time.h"
#include "io/child.h"
#include "io/node_clock.h"
#include "io/throttle.h"
#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/expected.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"
#include "node/neighbour_watch.h"
#include "wire/control_message.h"

namespace limb_ring::runtime {

/// Where a node's CPU comes from.
enum class CpuKind { none, child, attached };

inline const char* to_string(CpuKind kind) {
  switch (kind) {
    case CpuKind::none:
      return "none";
    case CpuKind::child:
      return "child";
    case CpuKind::attached:
      return "attached";
  }
  return "?";
}

/// What a node's daemon knows of its CPU, as status shows it.
struct CpuStatus {
  CpuKind kind = CpuKind::none;
  /// none: the node has no CPU, but a built-in sink. absent: never attached, gone, or ended with exit 0. booting: its
  /// process runs, but has not attached to the host port yet. running: attached. silent: attached, but without a word
  /// for three of its alive periods. failed: ended badly, did not attach in time, or cannot be executed; see last_exit.
  wire::CpuState state = wire::CpuState::none;
  pid_t pid = -1;           ///< of the process attached, else of the child; -1: neither
  bool ending = false;      ///< that one is a child that was killed and has not gone yet
  bool unsettled = false;   ///< on a virtual ring: a child has let go of the host port, and nobody knows why yet
  std::uint32_t boots = 0;  ///< times a CPU attached to the host port: higher means it really runs
  std::chrono::milliseconds silent{0};        ///< since its last word; 0 if none is attached
  std::chrono::milliseconds alive_period{0};  ///< promised by it or for it (cpu: {alive_period}); 0: no promise
  bool restarted_by_owner = false;            ///< attached: somebody restarts it when it is killed
  std::uint64_t resets = 0;
  std::string last_reset_reason;
  std::uint64_t exits = 0;                    ///< ends of children by themselves
  std::uint64_t failed_boots = 0;             ///< children that did not attach in time, or not at all
  std::chrono::milliseconds restart_wait{0};  ///< last time that was waited before a new start
  std::string last_exit;                      ///< "exit 3", "signal 9 (Killed)", "cannot execute ..."
};

/// Whether the CPU on the host port speaks. One that has promised a word every alive period is silent after three of
/// them without one, until it speaks again.
class SilenceWatch {
 public:
  using Time = event_loop::NodeClock::Time;
  using milliseconds = std::chrono::milliseconds;

  /// @param on_silent called when it falls silent
  SilenceWatch(event_loop::NodeClock& clock, std::function<void()> on_silent);

  /// A CPU has come, which counts as a word. @param alive_period promised by it; 0: no promise, so it is never silent
  void begin(milliseconds alive_period);
  /// From now on it does not fall silent any more.
  void end() { timer_->cancel(); }
  /// @return whether that has ended a silence
  bool spoke(Time now);

  bool silent() const { return silent_; }
  milliseconds silent_for() const { return std::chrono::duration_cast<milliseconds>(clock_.now() - spoke_); }
  milliseconds alive_period() const { return alive_period_; }

 private:
  Time silent_at() const;
  void watch();
  void watch_until(Time when);
  void time_over();

  event_loop::NodeClock& clock_;
  std::function<void()> on_silent_;
  std::unique_ptr<event_loop::Timer> timer_;
  Time over_at_{};  ///< when timer_ runs out
  milliseconds alive_period_{0};
  Time spoke_{};
  bool silent_ = false;
};

/// Runs the commands of pins wired to `exec`: side by side, but few, and none for ever. (ours)
class PinCommands {
 public:
  static constexpr std::size_t kAtOnce = 4;
  /// Shown by status as pin_commands_refused and so on.
  struct Counters {
    std::uint64_t refused = 0;    ///< the command is empty, its program is not found, or kAtOnce were running already
    std::uint64_t failed = 0;     ///< fork or exec failed, or it ended by a signal or with other than exit 0
    std::uint64_t timed_out = 0;  ///< killed at the deadline (also in `failed`)
  };

  PinCommands(boost::asio::io_context& io, std::chrono::milliseconds deadline, process::ProcessHandle::By by);

  /// Starts a command; its output goes to our standard error.
  /// @return why not; empty if it was started (its end is logged and counted).
  std::string run(const std::vector<std::string>& command, process::SpawnRequest request);
  /// Kills what is running.
  void stop();
  const Counters& counters() const { return counters_; }

 private:
  struct Slot {
    Slot(boost::asio::io_context& io, process::ProcessHandle::By by) : child(io, by), deadline(io) {}
    process::ChildProcess child;
    boost::asio::steady_timer deadline;
    std::string name;
  };
  Slot* free_slot();
  std::string refuse(std::string why);
  void start(Slot& slot, const process::SpawnRequest& request);
  void ended(Slot& slot, const process::ExitStatus& status);
  void timed_out(Slot& slot);
  void warn(const Slot& slot, const std::string& what);

  std::chrono::milliseconds deadline_;
  process::Throttle lines_{std::chrono::seconds(1), 10};
  std::array<Slot, kAtOnce> slots_;
  Counters counters_;
  std::shared_ptr<void> alive_ = std::make_shared<int>(0);  ///< outlived by queued handlers
};

/// Finds out what is wrong with the firmware of a node, by what its CPU sends, what it is given, and what it says of
/// itself. Time is an argument. What was found stays until the next CPU comes, but for what can mend itself: a sensor
/// that speaks again, commands that are obeyed. (ours)
class CpuWatch {
 public:
  static constexpr core::Duration kLook = std::chrono::seconds(1);
  /// A sensor or all joints that say nothing for so long, and for three of their periods, are silent.
  static constexpr core::Duration kSilence = std::chrono::seconds(2);
  static constexpr unsigned kCommands = 20;  ///< if none of these in a row is obeyed, it is not an accident
  static constexpr std::size_t kMostWarnings = 16;

  /// @param log is given each warning when it begins
  CpuWatch(const config::RingConfig& ring, const config::NodeConfig& node, std::function<void(const std::string&)> log)
      : ring_(ring),
        node_(node),
        state_rate_(ring.firmware.state_rate),
        log_(std::move(log)),
        heard_(node.sensors.size()) {}

  /// Another CPU has come.
  void begin(core::Time now);
  void end() { runs_ = false; }
  /// @name It has sent this on the joint channel
  ///@{
  void sent(const payload::Decoded<payload::JointState>& state, core::Time now);
  /// @param to whose sensor it may be: a bridge hands a sensor with a topic its values
  void sent(const payload::Decoded<payload::SensorReading>& reading, std::uint8_t to, core::Time now);
  ///@}
  /// It is given this on the joint channel.
  void given(payload::ByteView data);
  void spoke(core::Time now) { spoke_ = now; }
  /// It says of itself what is wrong: a sentence without its name.
  void told(const std::string& text);
  /// To be called now and then; looks every kLook.
  void look(core::Time now);

  const std::vector<Warning>& warnings() const { return warnings_; }
  std::uint64_t begun() const { return begun_; }  ///< warnings

 private:
  void warn(const char* rule, const std::string& text);
  /// @param text empty: any
  void mended(const char* rule, const std::string& text = {});
  void look_at(const std::string& what, double rate, core::Time heard, core::Time now);
  void look_at_commands();

  const config::RingConfig& ring_;
  const config::NodeConfig& node_;
  double state_rate_;
  std::function<void(const std::string&)> log_;
  bool runs_ = false;
  core::Time spoke_{}, looked_{}, state_heard_{};
  std::vector<core::Time> heard_;  ///< readings, by sensor
  bool has_states_ = false, commanded_ = false;
  unsigned commands_ = 0;               ///< since one was obeyed
  std::uint16_t refused_ = 0;           ///< by its last state
  std::uint16_t refused_at_first_ = 0;  ///< when the first of those commands came
  std::vector<Warning> warnings_;
  std::uint64_t begun_ = 0;
};

}  // namespace limb_ring::runtime
