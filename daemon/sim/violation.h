#pragma once

#include <functional>
#include <string>

#include "core/time.h"

namespace limb_ring::sim {

/// What the ring promises at every moment. (protocol.md sections 2 to 5)
enum class Promise {
  one_result,       ///< every send ends in exactly one result
  true_result,      ///< which says what has happened
  undamaged,        ///< what a CPU gets is what was sent, whole, and to it
  exactly_once,     ///< a packet is taken, a pin pulled, once between two restarts of the receiver
  in_order,         ///< packets of a source and priority leave, and are taken, in the order of asking
  priority_first,   ///< of what waits the highest priority goes first, onto the line and to the CPU
  interrupt_wait,   ///< an INTP waits for other INTPs and at most for odd bytes, trailer and CRC
  insertion_bound,  ///< of the insertion buffer
  no_circling,      ///< no packet goes on after its source is gone
  true_fbc,         ///< FBC goes on as the receivers' buffers say
  whole_again       ///< when all is mended the ring closes, and falls silent
};
const char* to_string(Promise promise);

struct Violation {
  Promise promise;
  core::Time at;
  std::string what;  ///< the nodes and packets involved
};
using Complain = std::function<void(Promise, std::string what)>;

}  // namespace limb_ring::sim
