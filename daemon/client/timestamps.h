#pragma once

#include <chrono>
#include <cstdint>

namespace limb_ring::firmware {

using std::chrono::nanoseconds;

/// One instant on both clocks. Monotonic time drives everything that happens here; wall time only
/// stamps what goes out and judges the stamps that come in, which are another node's.
struct Timestamps {
  nanoseconds monotonic{0};  ///< CLOCK_MONOTONIC
  std::int64_t wall_ns = 0;  ///< CLOCK_REALTIME, ns since 1970
};

}  // namespace limb_ring::firmware
