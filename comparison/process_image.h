#pragma once

#include <deque>
#include <vector>

#include "comparison/network.h"
#include "comparison/point_to_point.h"
#include "study/model_ring.h"

namespace limb_ring::study {

/// How EtherCAT's process image lies in its frames. All in bytes, from the first of the preamble.
class ProcessImage {
 public:
  explicit ProcessImage(const Medium& medium);

  unsigned frames() const { return frames_; }
  /// Preamble to FCS.
  unsigned length(unsigned frame) const;
  /// To the first byte of the next frame.
  unsigned pitch(unsigned frame) const;

  /// The frames with the first and the last byte of the node's slot.
  unsigned first_frame(NodeId node) const { return node * slot_ / share_; }
  unsigned last_frame(NodeId node) const { return (node * slot_ + slot_ - 1) / share_; }
  /// The first byte of its slot in first_frame().
  unsigned slot(NodeId node) const;
  /// Its byte for interrupt-like messages, in every frame.
  unsigned event(NodeId node) const;

 private:
  unsigned nodes_, slot_;
  unsigned frames_;
  unsigned share_;  ///< of the image, in every frame but the last
};

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

/// A master's cycle of telegrams: SERCOS II (IEC 61491), an optical ring whose master is node 0.
///
/// A cycle is the master's synchronization telegram (MST), one amplifier telegram (AT) of every slave
/// in its time slot, and the master data telegram (MDT) with a record for each node. Slaves only
/// hear the master: what one has for another goes in its AT to the master and in that cycle's MDT to the
/// other; what one has for the master has arrived with its AT. The master's own goes in the MDT. One
/// message per node and cycle. An interrupt-like message is a real-time bit in the status word of
/// the AT and in the control word of the MDT: it costs nothing and waits for no data.
///
///   telegram  BOF 1, ADR 1, content, FCS 2, EOF 1 bytes (HDLC)
///   MST       content 1
///   AT        content: status 2, service info 2, data B
///   MDT       content: for every slave control 2, service info 2, data B; for the master data B
///
/// Assumed, in its favour: no bit stuffing; no gaps between time slots; data records of any length; a
/// cycle as short as its telegrams (the standard has 62.5, 125, 250 us and multiples of 250 us);
/// slaves take their data in until their AT begins; the master copies in no time; slaves may read any
/// record of the MDT. Not in its favour: nothing is asked in step with the cycle; drives that are save up
/// to a cycle. The relay delay d is charged once per node; a telegram counts from its end.
class Sercos : public Network {
 public:
  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override;
  /// The ring is opened and restarted, through its communication phases (nobody can send
  /// meanwhile): 0, ten MSTs home; 1, every slave asked once; 2, eight parameters to every slave
  /// through its service channel, number and value, one slave a cycle; 3, the check for phase 4; then
  /// the newcomer's AT. In its favour: the parameters are few (ours: cycle, lengths, time slots, and
  /// the check for phase 3), handshakes and slaves take no time, each cycle is as short as its telegrams.
  Duration time_to_join(const Medium& medium) const override;
};

/// The slots of EtherCAT's process image, one per node: what its node has put in travels on to
/// the nodes behind it; what the master has repeated travels as far as its node.
class Slots {
 public:
  /// @param bytes of a slot. All references must outlive this.
  Slots(const Medium& medium, const std::vector<Message>& messages, SendQueues::Kind kind, unsigned bytes)
      : medium_(medium), messages_(messages), queues_(medium, messages, kind), bytes_(bytes), nodes_(medium.nodes) {}

  /// The first byte of the node's slot leaves the master.
  void begin(NodeId node, Time at_master);
  /// The end of the frame with the last byte of the node's slot leaves the master.
  void end(NodeId node, Time at_master, Deliveries& deliveries);

 private:
  static constexpr std::size_t kNone = SendQueues::kNone;
  /// A message, or a part of one.
  struct Content {
    std::size_t message = kNone;
    bool whole = false;  ///< with its last byte
    Time home{};         ///< when the master has it
  };
  struct Node {
    Content own, repeated;
    std::deque<Content> at_master;
  };
  Duration to(NodeId destination) const;

  const Medium& medium_;
  const std::vector<Message>& messages_;
  SendQueues queues_;
  unsigned bytes_;
  std::vector<Node> nodes_;
};

}  // namespace limb_ring::study
