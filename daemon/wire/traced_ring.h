#pragma once

#include <map>
#include <vector>

#include "wire/packet_assembler.h"
#include "wire/packet_trace.h"

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

/// Shows why a packet was late: takes the packets captured on a ring's lines, and gives the path of each. Knows no IO
/// and no clock; the times are the capture's, of a live ring or a virtual one. (ours)
///
/// What a packet waited for can only be told if both inputs and outputs were captured. If nodes
/// are on hosts whose clocks differ, their waits are wrong by as much.
class TracedRing {
 public:
  /// @param packets in any order
  explicit TracedRing(std::vector<SeenPacket> packets);
  TracedRing(const TracedRing&) = delete;
  TracedRing& operator=(const TracedRing&) = delete;

  /// The tries of packets are numbered from 0, in the order in which they were first seen.
  std::size_t trips() const { return trips_.size(); }
  const SeenPacket& first(std::size_t trip) const { return packets_[trips_[trip].seen.front()]; }
  const SeenPacket& last(std::size_t trip) const { return packets_[trips_[trip].seen.back()]; }
  /// First slice of its first try to last slice home; nothing if one of them was not seen.
  std::optional<std::chrono::nanoseconds> round_trip(std::size_t trip) const;
  /// Its path, hop by hop.
  PacketTrace trace(std::size_t trip) const;
  bool outputs_seen() const { return !outputs_.empty(); }

 private:
  const SeenPacket& clearest(std::size_t trip) const;
  TripEnd end_of(std::size_t trip) const;
  std::vector<Hop> hops_of(std::size_t trip) const;
  void add_company(Hop& hop) const;

  std::vector<SeenPacket> packets_;  ///< by began
  std::vector<Trip> trips_;
  std::vector<std::optional<std::size_t>> before_;  ///< by trip: the try before it
  std::map<wire::NodeId, LineHistory> outputs_;     ///< by node
};

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
