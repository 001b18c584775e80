#pragma once

#include "comparison/network.h"

namespace limb_ring::study {

/// Token passing: ARCNET (ANSI/ATA 878.1; sizes and times as in the COM20020 data sheet).
///
/// The node that holds the token sends at most one packet, then passes the token to the next node
/// in order of their IDs. Whoever begins to send, or to answer, does so one turnaround after the end
/// of what came before.
///
///   character  11 bits on the wire for 8
///   token      alert burst 6 bits, 3 characters (EOT, DID, DID)
///   packet     free buffer enquiry: alert burst, 3 characters (ENQ, DID, DID); answered by ACK: alert
///              burst, 1 character; then alert burst, SOH SID DID DID, count (1 character, 2 in a long
///              packet), data, CRC 2 characters; answered by ACK
///   data       short packets 1 to 253, long packets 257 to 508 bytes; 254 to 256 are padded to 257.
///              Longer messages go as several packets, one per visit of the token: 512 bytes are 508 + 4
///   turnaround 12.6 us at 2.5 Mbit/s, 31.5 bit times, scaled with the rate as the chips do
///
/// ARCNET has no interrupts and one transmit command; an interrupt-like message is a packet of one
/// byte that goes before everything else its node has to send.
///
/// Assumed, in its favour: no propagation delay, so the relay delay d does not enter (a bus relays
/// nothing); receivers are always free; the node's software is never late with the next packet.
class Arcnet : public Network {
 public:
  static constexpr unsigned kPacketData = 508;  ///< most bytes of data in a packet

  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override;
  /// A node that is switched on destroys the token with a reconfiguration burst (8 marks and a space,
  /// 765 times); after 82 us (at 2.5 Mbit/s) of silence the node with the highest ID begins again. In
  /// its favour: that ID is 255, which waits no further, the others follow without a gap, so that no
  /// missing node is asked for in vain, and each sends one packet before the newcomer gets the token.
  Duration time_to_join(const Medium& medium) const override;

  /// Bits of a packet with so many bytes of data, without the enquiry and the answers.
  /// @pre 1 <= data <= kPacketData
  static unsigned packet_bits(unsigned data);
};

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
