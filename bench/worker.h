#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>

#include "io/child.h"

namespace limb_ring::bench {

/// A forked copy of this process that does one thing and ends. It ends with us at the latest.
class Worker {
 public:
  /// What `work` throws is told on standard error.
  explicit Worker(const std::function<void()>& work);
  ~Worker();
  Worker(Worker&& other) noexcept = default;
  Worker& operator=(Worker&&) = delete;

  bool running();
  /// Waits until the worker sets `flag`, calling `poll` all the while. @return false where it has not within
  /// `patience`, or has ended without
  bool sets(const std::atomic<bool>& flag, const std::function<void()>& poll, std::chrono::milliseconds patience);

 private:
  std::unique_ptr<process::Child> child_;  ///< none: moved to another
};

}  // namespace limb_ring::bench
