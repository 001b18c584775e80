#pragma once

#include <map>
#include <optional>
#include <tuple>

#include "wire/packet_trace.h"

namespace limb_ring::capture {

/// Tells which try of a packet came before which: shown one try after the other, in their order. A retry
/// has the same sequence and the next try number, and follows before its source sends another packet of its
/// kind. What was refused is sent again for a second as a new packet: the same data to the same destination,
/// with the next sequence. (ours) Where a ring's `timeouts.refused` is longer, what comes after that second
/// counts as a new send.
class EarlierTries {
 public:
  /// One try of a packet.
  struct Try {
    SeenPacket seen;  ///< the sighting that shows most of it: with its trailer, where there is one
    std::chrono::nanoseconds began{0}, ended{0};  ///< first slice of its first sighting, last slice of its last
    TripEnd end = TripEnd::not_home;
  };
  /// The try before this one, as an index into the order of these calls; nothing where it is the first.
  std::optional<std::size_t> before(const Try& now);

 private:
  struct Known {
    Try tried;
    std::size_t index;
    std::chrono::nanoseconds refused_since;  ///< when it, or what it was sent again for, was refused first
  };
  using Unit = std::pair<wire::NodeId, bool>;                          // source, INTP
  using Route = std::tuple<wire::NodeId, wire::NodeId, std::uint8_t>;  // source, destination, PRI

  const Known* try_before(const Try& now) const;
  const Known* refused_before(const Try& now) const;
  void remember(const Known& known);

  std::size_t count_ = 0;
  std::map<Unit, std::map<std::uint8_t, Known>> by_try_;  ///< of the number each unit of a source sends now
  std::map<Route, Known> by_route_;                       ///< the last of each
};

}  // namespace limb_ring::capture
