#pragma once

#include <optional>
#include <string>

#include "config/ring_config.h"
#include "io/throttle.h"
#include "limb_ring/host_port.h"

namespace limb_ring::bridge {

/// What is logged of the interrupts that come to the bridge: a line a second for stops and one for the others, however
/// many come. `ring_events` has each.
class InterruptLog {
 public:
  explicit InterruptLog(const config::RingConfig& ring) : ring_(ring) {}

  /// "INT2 from node head: notify; 41 more since the last such line"; nothing where none is due
  std::optional<std::string> take(const Interrupt& interrupt,
                                  process::Throttle::Clock::time_point now = process::Throttle::Clock::now());

 private:
  const config::RingConfig& ring_;
  process::Throttle stops_{std::chrono::seconds(1)}, notifies_{std::chrono::seconds(1)};
};

}  // namespace limb_ring::bridge
