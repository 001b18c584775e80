#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "wire/packet_view.h"

namespace limb_ring::capture {

/// What a capture says of a packet on one line, without its data: all that is needed to follow it. (ours)
struct SeenPacket {
  std::chrono::nanoseconds began{0};  ///< its first slice, by the capture's clock
  std::chrono::nanoseconds last{0};   ///< its last slice; on a paced line its last odd bytes, trailer and CRC follow
  CaptureInfo info;
  std::uint8_t code = 0;  ///< incarnation, kind, try and sequence
  std::uint8_t hop = 0;
  wire::NodeId source{0};
  std::uint16_t size = 0;  ///< bytes, header to CRC
  /// The trailer's; nothing where the packet broke off before it.
  struct Trailer {
    std::uint8_t fbc = 0;
    wire::NodeId destination{0};
    std::uint8_t last = 0;   ///< PRI or INT
    std::uint32_t data = 0;  ///< CRC-32 of the data, which tells it from other data of that size
  };
  std::optional<Trailer> trailer;

  /// Whether both may be sightings or tries of one packet: what both have shown of it is the same.
  bool may_be(const SeenPacket& other) const;
  bool interrupt() const { return wire::code_of(code).interrupt; }
  wire::NodeId seen_by() const { return wire::NodeId{info.input ? info.to : info.from}; }
  /// How far on its way: 0 out of its source, 1 into the next node, 2 out of that ...
  unsigned stage() const { return 2u * hop + (info.input ? 1 : 0); }
  bool home() const { return info.input && info.to == source; }
};

/// Times before 1970 count as 1970.
SeenPacket seen(const CapturedPacket& packet);

}  // namespace limb_ring::capture
