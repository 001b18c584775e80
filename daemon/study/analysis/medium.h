#pragma once

#include <cstdint>

#include "core/time.h"
#include "sim/planned_ring.h"
#include "wire/data_packet.h"

namespace limb_ring::study {

using core::Duration;
using core::Time;
using wire::NodeId;

/// What a network is built of: the same figures for every method that is compared.
struct Medium {
  unsigned nodes = 16;                           ///< 2 to 254
  std::uint64_t rate = sim::kUsualRate;          ///< R, bit/s
  Duration relay_delay = sim::kUsualRelayDelay;  ///< d: line and node, once per hop
  unsigned payload = wire::kMaxPayload;          ///< B, bytes of data in a message, 1 to 512

  /// Time of one byte on the line, rounded to whole picoseconds.
  Duration byte_time() const { return bits(8); }
  /// Time of so many bits on the line, rounded to whole picoseconds.
  Duration bits(std::uint64_t count) const {
    const auto picoseconds = static_cast<long double>(count) * 1'000'000'000'000 + rate / 2;
    return Duration{static_cast<std::int64_t>(picoseconds / rate)};
  }
};

}  // namespace limb_ring::study
