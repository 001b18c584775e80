#pragma once

#include <chrono>
#include <csignal>
#include <utility>

namespace limb_ring::process {

/// Finds out that this process stood still: stopped by Ctrl-Z, or with its whole machine. What it does at fixed times
/// goes on that much later then, rather than all at once. For a loop that comes round every SignalWait::kTick.
class Standstill {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kLeast{1};  ///< a busy machine keeps a process waiting for less

  explicit Standstill(Time now) : last_(now) {}
  /// To be called in each round. @return how long it stood still since the round before; 0: it did not
  std::chrono::nanoseconds look(Time now) {
    const auto passed = now - std::exchange(last_, now);
    if (passed < kLeast) return {};
    total_ += passed;
    return passed;
  }
  /// All of it until now.
  std::chrono::nanoseconds total() const { return total_; }

 private:
  Time last_;
  std::chrono::nanoseconds total_{0};
};

/// It was started to ignore that its terminal is gone (nohup).
inline bool ignores_hangup() {
  struct sigaction action {};
  return ::sigaction(SIGHUP, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// Holds back the signals that a parent of processes waits for (SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGCHLD) and hands
/// them out one by one, so that nothing happens between two instructions. A hangup that it was started to ignore
/// (nohup) stays ignored.
class SignalWait {
 public:
  static constexpr std::chrono::milliseconds kTick{50};  ///< how soon Ctrl-C is seen

  SignalWait();
  ~SignalWait() { release(); }
  SignalWait(const SignalWait&) = delete;
  SignalWait& operator=(const SignalWait&) = delete;

  /// The signals come as they did before: for a copy of this process, which does not wait for them, or while somebody
  /// else handles them.
  void release() const;
  /// Held back again.
  void hold() const;
  /// The next one; 0 if another signal was handled first.
  int next() const;
  /// The next one, waiting up to `timeout`; 0 if none came.
  int next(std::chrono::milliseconds timeout) const;
  /// Waits up to `timeout`. @return whether one came that asks to end
  bool asked_to_end(std::chrono::milliseconds timeout) const { return asks_to_end(next(timeout)); }
  /// One that asks to end came before, or is here now.
  bool was_asked_to_end() const { return asked_to_end(std::chrono::milliseconds(0)) || asked_; }
  static bool asks_to_end(int signal) {
    return signal == SIGINT || signal == SIGTERM || signal == SIGHUP || signal == SIGQUIT;
  }

 private:
  int note(int signal) const;

  sigset_t ours_{}, before_{};
  mutable bool asked_ = false;
};

}  // namespace limb_ring::process
