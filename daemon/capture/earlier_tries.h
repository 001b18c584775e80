#pragma once

#include <map>
#include <optional>
#include <tuple>

#include "capture/packet_way.h"

namespace limb_ring::capture {

/// Tells which try of a packet came before which: shown one try after the other, in their order. A retry
/// has the same sequence and the next try number; what was refused is sent again as a new packet of the
/// same destination, priority and channel.
class EarlierTries {
 public:
  /// The try before this one, as an index into the order of these calls; nothing where it is the first.
  /// @param trailer of the packet, where any line has shown it
  std::optional<std::size_t> before(const SeenPacket& first, const std::optional<SeenPacket::Trailer>& trailer,
                                    WayEnd end);

 private:
  struct Try {
    std::size_t index;
    std::optional<wire::NodeId> destination;
    WayEnd end;
  };
  using Route = std::tuple<wire::NodeId, wire::NodeId, std::uint8_t>;  // source, destination, PRI

  std::optional<std::size_t> try_before(const SeenPacket& first,
                                        const std::optional<SeenPacket::Trailer>& trailer) const;
  std::optional<std::size_t> refused_before(const SeenPacket& first,
                                            const std::optional<SeenPacket::Trailer>& trailer) const;

  std::size_t count_ = 0;
  std::map<std::pair<wire::NodeId, std::uint8_t>, Try> by_code_;  ///< source, Code: the last of them
  std::map<Route, Try> by_route_;
};

}  // namespace limb_ring::capture
