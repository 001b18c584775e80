#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "ring/promise_watch.h"
#include "ros_bridge/throttle.h"

namespace limb_ring::bridge {

/// Judges the ring's promises, as `ringctl judge` does, for `/diagnostics`: "promises". A thread of its own.
class PromisesOut {
 public:
  PromisesOut(const config::RingConfig& ring, const ConnectOptions& daemon);
  ~PromisesOut();
  PromisesOut(const PromisesOut&) = delete;
  PromisesOut& operator=(const PromisesOut&) = delete;

  /// OK, or ERROR once one was broken, with counts and the last one. May be called by any thread.
  void tell(diagnostic_updater::DiagnosticStatusWrapper& out) const;

 private:
  void run();

  Throttle told_{std::chrono::seconds(1)};  // the thread's alone, as the next
  live::PromiseWatch watch_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  promises::JudgeCounts counts_;
  std::size_t watched_ = 0;
  std::string last_, problem_;
  std::thread thread_;
};

}  // namespace limb_ring::bridge
