#pragma once

#include <map>

#include "wire/packet_trace.h"
#include "wire/packet_trips.h"

namespace limb_ring::capture {

/// Shows why a packet was late: takes the packets captured on a ring's lines, and gives the path of each. Knows no IO
/// and no clock; the times are the capture's, of a live ring or a virtual one. (ours)
///
/// What a packet waited for can only be told where both inputs and outputs were captured. If nodes
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
