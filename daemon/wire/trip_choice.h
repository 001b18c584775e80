#pragma once

#include "wire/traced_ring.h"

namespace limb_ring::capture {

/// Which packets somebody wants explained. What is left empty lets every packet pass.
struct TripChoice {
  std::optional<wire::NodeId> source;
  std::optional<std::uint8_t> sequence;          ///< of its Code: 0..7, comes again after eight
  std::optional<std::chrono::nanoseconds> at;    ///< was on its way then, by the capture's clock
  std::optional<std::chrono::nanoseconds> over;  ///< its round trip was longer
};

/// Numbers of the trips (of TracedRing) that fit, the longest round trip first. Tries that were not seen
/// from their source to their home are chosen only by sequence or time, and come before all others: they
/// took longest.
std::vector<std::size_t> choose_trips(const TracedRing& ring, const TripChoice& choice);

}  // namespace limb_ring::capture
