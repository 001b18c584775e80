#pragma once

#include <cstdint>

namespace limb_ring::core {

/// Everything a network controller counts: (name, what one count means). Every loss has a name.
#define LIMB_RING_COUNTERS(X)                                                                                   \
  X(relayed_data, "DATP passed on")                                                                             \
  X(relayed_interrupts, "INTP passed on")                                                                       \
  X(sent_data, "own DATP put onto the line, retries included")                                                  \
  X(sent_interrupts, "own INTP put onto the line, retries included")                                            \
  X(embedded_interrupts, "INTP embedded into a DATP that was being sent")                                       \
  X(returned_data, "own DATP that came home as sent")                                                           \
  X(returned_interrupts, "own INTP that came home as sent")                                                     \
  X(received_data, "DATP taken for the CPU")                                                                    \
  X(received_control, "hello or beacon taken")                                                                  \
  X(pins_pulled, "INTP that pulled a pin")                                                                      \
  X(ended_delivered, "send ended: delivered")                                                                   \
  X(ended_refused, "send ended: refused")                                                                       \
  X(ended_no_such_node, "send ended: no such node")                                                             \
  X(ended_lost, "send ended: lost")                                                                             \
  X(ended_unconfirmed, "send ended: unconfirmed")                                                               \
  X(ended_rejected, "send ended: rejected")                                                                     \
  X(ended_cancelled, "send ended: cancelled")                                                                   \
  X(timeouts, "try that did not come home in time")                                                             \
  X(retries, "try sent again, for time-out or damage")                                                          \
  X(refusals, "return with a refusal, to be tried again")                                                       \
  X(hellos, "hello said")                                                                                       \
  X(duplicates, "packet or interrupt taken before, not delivered again")                                        \
  X(earlier_incarnation, "packet refused: its source has begun a later incarnation since")                      \
  X(refused_no_buffer, "DATP refused: no receive buffer of its priority free")                                  \
  X(refused_cpu_absent, "DATP refused: the CPU is configured but not there")                                    \
  X(refused_joining, "user's DATP refused: the own hello is not home yet")                                      \
  X(refused_unwired, "INTP refused: its pin is wired to nothing")                                               \
  X(crc_errors, "packet that came in with a wrong CRC")                                                         \
  X(malformed_packets, "packet discarded: header or trailer is none")                                           \
  X(stray_slices, "slice discarded: no packet was open")                                                        \
  X(oversize_packets, "packet aborted: more than 524 bytes")                                                    \
  X(stalled_packets, "packet aborted: its next slice did not come in time")                                     \
  X(broken_off_packets, "packet aborted: its link was lost or another began inside it")                         \
  X(aborts_received, "abort that came in from upstream")                                                        \
  X(insertion_buffer_full, "incoming DATP dropped whole: no room in the insertion buffer")                      \
  X(interrupt_buffer_full, "incoming INTP dropped: no room beside the insertion buffer")                        \
  X(dropped_no_output, "packet dropped: the output line is gone")                                               \
  X(returns_unmatched, "own packet discarded: matches nothing outstanding")                                     \
  X(returns_damaged, "own packet that came home damaged")                                                       \
  X(orphans_hop, "foreign packet discarded: HOP says its source is gone")                                       \
  X(orphans_bypassed, "packet of a bypassed node discarded")                                                    \
  X(orphans_cut_off, "packet discarded: its source is beyond the break this node is behind (fold-back)")        \
  X(control_malformed, "channel 1 packet that is neither hello nor beacon")                                     \
  X(flushed_on_reset, "received packet thrown away because the CPU was reset")                                  \
  X(retries_of_unheard_nodes, "retry not taken: its source has not been heard since the own start (fold-back)") \
  X(retries_of_unaware_nodes, "retry not taken: its source may not know of the own start")                      \
  X(doubtful_retries, "retry not taken: its number was decided too long ago to be surely its own (fold-back)")  \
  X(folds, "input or output taken over by the second line")                                                     \
  X(fold_discarded, "slice on the second line that nobody was to have")                                         \
  X(fold_held_dropped, "slice dropped while the first line came back")                                          \
  X(duplicate_id_signs, "sign that another node has this node's id")

/// The last packet that was counted so: whom its header names, which may be damaged.
struct LastCounted {
  std::uint8_t source = 0, hop = 0;

  template <class Archive>
  void archive(Archive& a) {
    a("source", source)("hop", hop);
  }
};

struct Counters {
#define LIMB_RING_COUNTER_MEMBER(name, meaning) std::uint64_t name = 0;
  LIMB_RING_COUNTERS(LIMB_RING_COUNTER_MEMBER)
#undef LIMB_RING_COUNTER_MEMBER
  LastCounted last_malformed, last_oversize, last_control, last_duplicate;

  /// Calls visit(name, meaning, value) for each, in the order above.
  template <class Visit>
  void each(Visit visit) const {
#define LIMB_RING_COUNTER_VISIT(name, meaning) visit(#name, meaning, name);
    LIMB_RING_COUNTERS(LIMB_RING_COUNTER_VISIT)
#undef LIMB_RING_COUNTER_VISIT
  }
  template <class Archive>
  void archive(Archive& a) {
#define LIMB_RING_COUNTER_ARCHIVE(name, meaning) a(#name, name);
    LIMB_RING_COUNTERS(LIMB_RING_COUNTER_ARCHIVE)
#undef LIMB_RING_COUNTER_ARCHIVE
    a("last_malformed", last_malformed)("last_oversize", last_oversize);
    a("last_control", last_control)("last_duplicate", last_duplicate);
  }
};

/// Adds 1 to the counter. @return `result`, so that a rule and its counter stand in one line
template <class Result>
Result counted(std::uint64_t& counter, Result result) {
  ++counter;
  return result;
}

}  // namespace limb_ring::core
