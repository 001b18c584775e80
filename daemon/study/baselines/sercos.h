#pragma once

#include "study/comparison/network.h"

namespace limb_ring::study {

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

}  // namespace limb_ring::study
