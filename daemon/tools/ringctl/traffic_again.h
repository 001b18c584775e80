#pragma once

#include <cstdint>
#include <vector>

#include "wire/pcapng.h"

namespace limb_ring::ringctl {

/// A packet of a capture that is to be sent again by its source.
struct ReplaySend {
  std::int64_t after_ns = 0;  ///< since the first of them
  wire::NodeId source{0};
  wire::NodeId destination{0};
  bool interrupt = false;
  std::uint8_t last = 0;           ///< factor, or priority and channel
  std::vector<std::uint8_t> data;  ///< empty for an interrupt
};

/// What of a capture is sent again, in its order, and why the rest is not.
struct ReplayPlan {
  std::vector<ReplaySend> sends;
  std::uint64_t control = 0;    ///< hellos, beacons: the network controllers' own
  std::uint64_t broken = 0;     ///< aborted, truncated, bad CRC
  std::uint64_t repeated = 0;   ///< a retry of what was sent before it
  std::uint64_t elsewhere = 0;  ///< seen on another line than the one its source is taken from
};

/// A packet passes many lines and may have been captured on several. Each source's packets are taken from one
/// line only: the line out of it, or if that was not captured, the first line on which it was seen.
ReplayPlan plan_replay(capture::PcapngReader& reader);

}  // namespace limb_ring::ringctl
