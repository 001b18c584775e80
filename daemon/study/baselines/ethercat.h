#pragma once

#include "study/comparison/network.h"

namespace limb_ring::study {

/// One summation frame from a master: EtherCAT (IEC 61158-3/-4 type 12), process data in logical
/// addressing (LRW), a ring whose master is node 0.
///
/// The process image holds one slot of B bytes per node. The master sends it over and over, in as few
/// frames as hold it, evenly shared and back to back. A node puts its message into its slot as the
/// frame passes; nodes behind it read it from the same frame. For nodes before it the master, who
/// has the frame home, repeats the slot in the next frame that carries it. A second datagram, in every
/// frame, has one byte per node for interrupt-like messages, so that they need not wait for a cycle.
///
///   frame     preamble 8, Ethernet header 14, EtherCAT header 2, datagrams at most 1498, FCS 4,
///             gap 12 bytes; datagrams of less than 44 bytes are padded to that
///   datagram  header 10, data, working counter 2 bytes
///
/// Assumed, in its favour: the frames follow each other without a pause (masters pause until their
/// next cycle); the master needs no time between a frame's return and the next
/// one's slot; a node may put its message in until its slot passes; no mailbox, no distributed clocks
/// in the frame; who a message is for costs no bytes, as with process data that is mapped beforehand. Not
/// in its favour: nothing is asked in step with the cycle; an application that is saves the wait for its
/// slot, up to a cycle. The relay delay d is charged once per node, N times per lap; a frame counts
/// from the end of its FCS.
class EtherCat : public Network {
 public:
  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override;
  /// Five frames and their return, one after the other: the one by which the master sees the newcomer (it
  /// was switched on just behind the one before), configuration with the request of PREOP, its
  /// confirmation, the request of SAFEOP, its confirmation; then until its slot. In its favour:
  /// states change at once, their datagrams cost nothing; link-up, EEPROM and mailbox, which take far
  /// longer than all of this, are left out.
  Duration time_to_join(const Medium& medium) const override;
};

}  // namespace limb_ring::study
