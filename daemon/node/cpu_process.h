#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <csignal>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "io/child.h"
#include "io/node_clock.h"
#include "io/process_state.h"
#include "io/program.h"
#include "node/cpu_status.h"

namespace limb_ring::runtime {

/// What a CpuProcess tells its owner.
class CpuEvents {
 public:
  /// State, pid or boots have changed: see status(). Comes from the event loop, never from
  /// inside a call; several changes may come as one.
  virtual void on_cpu_changed() = 0;

 protected:
  ~CpuEvents() = default;
};

/// What became of something that was to be done to the CPU.
struct CpuActionResult {
  bool done = false;
  bool comes_back = false;  ///< reset: somebody starts the CPU again
  std::string message;      ///< for people: what was done, or why not
};

/// A process that is sent this signal ends, unless it catches it.
inline bool is_fatal(int signal) { return signal == SIGKILL || signal == SIGSEGV || signal == SIGABRT; }

/// How a node's CPU is started, watched and ended.
struct CpuOptions {
  config::CpuConfig cpu;
  /// For the child and the commands of pins: LIMB_RING_RING, LIMB_RING_NODE, LIMB_RING_CONFIG.
  std::vector<std::pair<std::string, std::string>> environment;
  std::string program_folder = process::own_folder();  ///< searched before PATH
  std::chrono::milliseconds boot_timeout{5000};
  std::chrono::milliseconds stop_timeout{500};       ///< from SIGTERM to SIGKILL
  std::chrono::milliseconds command_timeout{10000};  ///< of a pin's command
  process::BackOff::Limits back_off;
  /// The boot time on a virtual ring, by the ring's clock; 0: no virtual ring. No child attaches earlier, and a child
  /// that ends earlier by itself is seen to end only then. The end of an attached child is seen once both its process
  /// and its connection have ended, so that their order does not matter.
  std::chrono::nanoseconds boots_for{0};
  /// The CPU's process has been sent that signal; may be empty.
  std::function<void(int number)> on_signal;
  std::string log_prefix;
  /// Cores of the CPU's processes, if the daemon has pinned itself to one; empty: the same cores as this process.
  std::optional<cpu_set_t> affinity;
  int output = -1;  ///< descriptor for what they print; -1: as this process
  process::ProcessHandle::By by = process::ProcessHandle::By::pidfd;
};

/// The CPU of one node: the process that runs the joint's firmware, a child started here or an
/// outside process on the host port. A reset kills it, whatever state it is in; the network
/// controller does not wait for that. (paper: a pin wired to the CPU's reset circuit; the
/// processes are ours)
class CpuProcess {
 public:
  using Time = event_loop::NodeClock::Time;

  /// All must outlive this. Silence and restarts are timed by `clock`, booting and ending by real time.
  CpuProcess(boost::asio::io_context& io, event_loop::NodeClock& clock, CpuOptions options, CpuEvents& events);
  /// Kills the child. stop() is the gentle way.
  ~CpuProcess();

  /// Starts the child, if the configuration names one.
  void start();
  /// Ends the child and the commands of pins: SIGTERM, then SIGKILL; `done` is called from the
  /// event loop. An attached outside process is left alone.
  void stop(std::function<void()> done);

  /// The process `pid` has connected and will be attached. If it is the child, it has booted in time.
  void greeted(pid_t pid) {
    if (child_.owns(pid)) boot_timer_.cancel();
  }
  /// The same process is no longer connected, and was not attached. If it is the child, its boot is timed again.
  void left(pid_t pid) {
    if (child_.owns(pid) && !stopping_) watch_boot();
  }
  /// A process took the CPU's place on the host port. `pid` by SO_PEERCRED.
  /// @return false if that process has ended or is being killed: close its connection.
  bool attached(pid_t pid, bool restarted_by_owner, std::chrono::milliseconds alive_period);
  /// The connection of `pid` has ended. Has no effect if another process has taken its place.
  void detached(pid_t pid);
  /// The CPU said something.
  void spoke(Time now);

  /// Kills the CPU, stopped or not, and starts the child again at once; an attached process is
  /// started again by its owner, if it has one. The caller ends its connection.
  CpuActionResult reset(const std::string& reason);
  /// Kills and reaps the child at once and for good. Only for use just before this process ends.
  void kill() { child_.kill(); }
  /// Sends a POSIX signal to the CPU's process.
  CpuActionResult signal(int number);
  /// Runs the command of a pin wired to `exec`.
  CpuActionResult run(const std::vector<std::string>& command);

  CpuStatus status() const;
  const PinCommands::Counters& command_counters() const { return commands_.counters(); }

 private:
  /// The child that was started last.
  struct LastChild {
    Time started_at{};
    bool has_booted = false;                 ///< it has attached
    bool was_reset = false;                  ///< it is being killed, and started again when it is gone
    bool boot_failed = false;                ///< it is being killed because it did not attach
    bool fatal_sent = false;                 ///< it was sent a signal that ends it
    std::optional<process::ExitStatus> end;  ///< not seen yet

    bool is_being_killed() const { return was_reset || boot_failed; }
  };

  /// The process that holds the CPU's place on the host port.
  struct Attached {
    process::ProcessHandle process;
    bool restarted_by_owner;
  };

  wire::CpuState state() const;
  CpuKind kind() const;
  pid_t pid() const;
  void changed();

  process::SpawnRequest request() const;
  void start_child();
  void start_found(const std::string& path);
  void could_not_start(const process::ExitStatus& why);
  void boot_timed_out();
  void child_ended(const process::ExitStatus& status);
  void see_end();
  void see_end_at(Time when);
  bool on_virtual_ring() const { return options_.boots_for.count() != 0; }
  void ended_by_itself(const process::ExitStatus& status);
  void did_not_boot(const std::string& why);
  std::chrono::milliseconds ran() const;
  void restart_later(std::chrono::milliseconds ran);
  void restart_due();
  CpuActionResult reset_child();
  CpuActionResult kill_attached();
  void watch_boot();
  void let_go();  ///< nobody holds the CPU's place any more
  void force_stop();
  void stopped();
  template <class Action>
  void after(boost::asio::steady_timer& timer, Time when, Action action);

  boost::asio::io_context& io_;
  event_loop::NodeClock& clock_;
  CpuOptions options_;
  CpuEvents& events_;
  process::ChildProcess child_;
  PinCommands commands_;
  process::BackOff back_off_;
  boost::asio::steady_timer boot_timer_, stop_timer_;
  std::unique_ptr<event_loop::Timer> restart_timer_, end_timer_;
  SilenceWatch silence_;
  std::optional<Attached> attached_;
  process::ProcessHandle killed_;  ///< an attached process on its way out
  LastChild last_;
  bool failed_ = false;  ///< the last child ended badly, or could not be started
  bool stopping_ = false;
  bool event_posted_ = false;
  std::function<void()> on_stopped_;
  CpuStatus counts_;  ///< boots, resets, exits and their texts; the rest is derived
  std::shared_ptr<void> alive_ = std::make_shared<int>(0);  ///< outlived by queued handlers
};

}  // namespace limb_ring::runtime
