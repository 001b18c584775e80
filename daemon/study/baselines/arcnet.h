#pragma once

#include "study/comparison/network.h"

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

}  // namespace limb_ring::study
