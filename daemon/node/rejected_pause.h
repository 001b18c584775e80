#pragma once

#include <algorithm>
#include <chrono>

#include "core/network_controller.h"

namespace limb_ring::runtime {

/// How long one who sends a packet as the last one ends, with `period` between, waits for the next. A rejection comes
/// at once: sending again at once would keep the event loop, or the clock of a virtual ring, from all else. (ours)
inline std::chrono::nanoseconds pause_after(core::Outcome outcome, std::chrono::nanoseconds period) {
  constexpr std::chrono::nanoseconds kAfterRejection = std::chrono::milliseconds(1);
  return outcome == core::Outcome::rejected ? std::max(period, kAfterRejection) : period;
}

}  // namespace limb_ring::runtime
