#pragma once

#include <vector>

#include "wire/packet_assembler.h"

namespace limb_ring::capture {

/// One try of one packet: where it was seen, in the order of its way; places in the list that was given.
struct Trip {
  std::vector<std::size_t> seen;
};

/// Sorts what was seen on all lines into tries of packets. A try is known by source, kind, number of the try and
/// sequence number; HOP and line say how far it has come. A sighting belongs to the try that was last seen nearest
/// before it (lines keep order). Sequence numbers repeat, so a sighting begins a new packet in these cases:
///   - the try was seen at this place already
///   - the data is not the same
///   - the try must be over: its source has since begun a whole turn of sequence numbers of that kind; or at least one
///     packet, and more than a second has passed
///
/// @param packets in the order of `began`; see traced_ring.h
std::vector<Trip> sort_into_trips(const std::vector<SeenPacket>& packets);

}  // namespace limb_ring::capture
