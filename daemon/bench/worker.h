#pragma once

#include <sys/types.h>

#include <functional>

namespace limb_ring::bench {

/// A forked copy of this process that does one thing and ends. It ends with us at the latest.
class Worker {
 public:
  /// What `work` throws is told on standard error.
  explicit Worker(const std::function<void()>& work);
  ~Worker();
  Worker(Worker&& other) noexcept;
  Worker& operator=(Worker&&) = delete;

  bool running();

 private:
  pid_t pid_;
};

}  // namespace limb_ring::bench
