#pragma once

#include <vector>

#include "capture/seen_packet.h"

namespace limb_ring::capture {

/// One try of one packet: where it was seen, in the order of its way; places in the list that was given.
struct Trip {
  std::vector<std::size_t> seen;
};

/// Sorts what was seen on all lines into tries of packets. A packet is known by source, kind, try and
/// sequence; HOP and line say how far it is. A sighting goes to the try that was last seen nearest before it
/// (lines keep order). Numbers come again, so a sighting is the first of a new packet where the try has been there
/// already, where what it carries is another, and where the try must be over: its source has begun others of that kind
/// since, a whole turn of the numbers, or one, and more than a second has passed.
///
/// @param packets in the order of `began`; see traced_ring.h
std::vector<Trip> sort_into_trips(const std::vector<SeenPacket>& packets);

}  // namespace limb_ring::capture
