#pragma once

#include "study/comparison/network.h"

namespace limb_ring::study {

/// A shared bus with arbitration by identifier: CAN FD (ISO 11898-1:2015), 11-bit identifiers. An
/// M-LVDS bus (TIA/EIA-899) that is shared the same way behaves alike.
///
/// When the bus is free, all nodes with a frame waiting start together and the lowest identifier
/// wins without loss of time; a frame on the bus is never interrupted. The identifier is the kind
/// of message (interrupt-like, then priorities 0 to 3), then the node number: so equal priorities
/// go by node, and in saturation the highest node number starves. That is how CAN works.
///
///   bits  SOF 1, identifier 11, RRS IDE FDF res BRS ESI 1 each, DLC 4 | data 8 each |
///         stuff count 4, CRC 17 (up to 16 bytes) or 21, their fixed stuff bits (one before, one
///         after every fourth bit) 6 or 7 | CRC delimiter, ACK, ACK delimiter 1 each, EOF 7 |
///         intermission 3
///   data  0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes; longer messages go as several frames, the
///         last padded to the next of these sizes. An interrupt-like message has no data.
///
/// Assumed, in its favour: arbitration at the full data rate, which no bus of more than a few
/// centimetres permits at 1 Gbit/s; no dynamic stuff bits; no propagation delay, so the relay
/// delay d does not enter (nothing is relayed); no transport header on the frames of a long message.
class CanBus : public Network {
 public:
  static constexpr unsigned kFrameData = 64;  ///< most bytes of data in a frame

  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override;
  /// Until 11 recessive bits in a row were seen (ISO 11898-1, bus integration), switched on at the
  /// worst instant: just after the tail of a frame, which has exactly 11, has begun.
  Duration time_to_join(const Medium& medium) const override;

  /// Bits of a frame with at least so many bytes of data, to the end of EOF.
  /// @pre data <= kFrameData
  static unsigned frame_bits(unsigned data);
  static constexpr unsigned kIntermission = 3;  ///< bits
};

}  // namespace limb_ring::study
