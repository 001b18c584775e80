#pragma once

namespace limb_ring::promises {

/// What the ring promises at every moment. (protocol.md sections 2 to 5)
enum class Promise {
  one_result,       ///< every send ends in exactly one result
  true_result,      ///< which says what has happened
  undamaged,        ///< what a CPU gets is what was sent, whole, and to it
  exactly_once,     ///< a packet is taken, a pin pulled, once, also where the receiver restarts
  in_order,         ///< packets of a source and priority leave, and are taken, in the order of asking
  priority_first,   ///< of what waits the highest priority goes first, onto the line and to the CPU
  interrupt_wait,   ///< an INTP waits for other INTPs and at most for odd bytes, trailer and CRC
  insertion_bound,  ///< of the insertion buffer
  no_circling,      ///< no packet goes on after its source is gone
  true_fbc,         ///< FBC goes on as the receivers' buffers say
  whole_again       ///< when all is mended the ring closes, and falls silent
};

constexpr const char* to_string(Promise promise) {
  switch (promise) {
    case Promise::one_result:
      return "every send ends in exactly one result";
    case Promise::true_result:
      return "a result says what has happened";
    case Promise::undamaged:
      return "nothing damaged, partial or misled is delivered";
    case Promise::exactly_once:
      return "exactly once";
    case Promise::in_order:
      return "order is kept per source and priority";
    case Promise::priority_first:
      return "the highest priority goes first";
    case Promise::interrupt_wait:
      return "an INTP waits at most for other INTPs and for a piece of a DATP";
    case Promise::insertion_bound:
      return "the insertion buffer keeps its bound";
    case Promise::no_circling:
      return "no packet goes on round the ring after its source is gone";
    case Promise::true_fbc:
      return "FBC is truthful";
    case Promise::whole_again:
      return "when all is mended the ring closes and falls silent";
  }
  return "";
}

}  // namespace limb_ring::promises
