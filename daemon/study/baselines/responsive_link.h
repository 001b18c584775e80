#pragma once

#include "study/comparison/network.h"

namespace limb_ring::study {

/// Point-to-point links with priority overtaking and a separate event link: Responsive Link
/// (ISO/IEC 24740:2008; N. Yamasaki, "Responsive Link for Distributed Real-Time Processing", IWIA 2007).
///
/// The nodes form a ring of full-duplex links; a packet takes the shorter way, half-way round the
/// even nodes' the one and the odd nodes' the other. At every node the packets for a line wait by
/// priority, so a higher one overtakes all that have not begun; equal ones go in the order in which they
/// came, a tie to the node's own. A packet on the line is never interrupted. Events have lines and
/// packets of their own.
///
///   data packet   64 bytes: 56 of data, 8 of header and trailer; longer messages go as several
///   event packet  16 bytes
///
/// Assumed, in its favour: cut-through at the same relay delay d as ours; no line code and none of its
/// forward error correction; every line, event lines too, at the full rate R. So a node has four
/// lines out where our ring has one: twice the fibres and more, and several messages can be under
/// way on different parts of the ring at once. Its efficiency against R can exceed 1.
class ResponsiveLink : public Network {
 public:
  static constexpr unsigned kDataPacket = 64, kPacketData = 56, kEventPacket = 16;  ///< bytes

  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override;
  /// None: the lines out of a node are its own (hot plug). Routing tables are taken to know it already.
  Duration time_to_join(const Medium& medium) const override;
};

}  // namespace limb_ring::study
