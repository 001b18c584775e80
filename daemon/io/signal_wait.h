#pragma once

#include <chrono>
#include <csignal>

namespace limb_ring::process {

/// Holds back the signals that a parent of processes waits for (SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGCHLD) and hands
/// them out one by one, so that nothing happens between two instructions.
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
  /// The next one; 0 where another signal was handled first.
  int next() const;
  /// The next one, waiting up to `timeout`; 0 where none came.
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
