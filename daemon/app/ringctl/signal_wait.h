#pragma once

#include <chrono>
#include <csignal>

namespace limb_ring::ringctl {

/// Holds back the signals `up` waits for (SIGINT, SIGTERM, SIGHUP, SIGCHLD) and hands them out one
/// by one, so that nothing happens between two instructions.
class SignalWait {
 public:
  static constexpr std::chrono::milliseconds kTick{50};  ///< how soon Ctrl-C is seen

  SignalWait();
  ~SignalWait();
  SignalWait(const SignalWait&) = delete;
  SignalWait& operator=(const SignalWait&) = delete;

  /// The next one, waiting up to `timeout`; 0 where none came.
  int next(std::chrono::milliseconds timeout);
  /// Waits up to `timeout`. @return whether one came that asks to end
  bool asked_to_end(std::chrono::milliseconds timeout) { return asks_to_end(next(timeout)); }
  static bool asks_to_end(int signal) { return signal == SIGINT || signal == SIGTERM || signal == SIGHUP; }

 private:
  sigset_t ours_{}, before_{};
};

}  // namespace limb_ring::ringctl
