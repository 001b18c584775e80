#pragma once

#include <cstdint>

namespace limb_ring {

/// Why a send was not delivered. (ours) `rejected` sends were never on the line. If another node refused a packet, the
/// source can only infer the reason, from its ring's file and from the beacons of the other nodes.
enum class Reason : std::uint8_t {
  none,             ///< delivered
  bad_size,         ///< rejected: not 1 to 512 bytes
  bad_destination,  ///< rejected: no node of that id is configured
  bad_priority,     ///< rejected: not 0 to 3
  bad_channel,      ///< rejected: not 0 to 63, or 1, which is the network controllers' own
  bad_factor,       ///< rejected: not 0 to 7
  input_unwired,    ///< rejected: the interrupt input is wired to nothing, or is not 0 to 7
  queue_full,       ///< rejected: the send queue is full (limits.send_queue)
  not_in_ring,      ///< rejected: this node is not in a ring
  no_way_out,       ///< rejected: the packet could not go onto the line within timeouts.queue
  needs_force,      ///< rejected: it would reset every CPU at once
  cpu_absent,       ///< refused: the destination is to have a CPU, and none is there
  cpu_booting,      ///< refused: its CPU boots
  cpu_failed,       ///< refused: its CPU has failed
  cpu_silent,       ///< refused: its CPU hangs and takes nothing out of the receive buffers
  no_buffer,        ///< refused: no receive buffer of that priority is free
  joining,          ///< refused: the destination is joining the ring
  pin_unwired,      ///< refused: the pin is wired to nothing there
  node_missing,     ///< no such node: it is down or bypassed
  no_return,        ///< lost: no try came home whole in time
  open_chain,       ///< unconfirmed: the ring is open, and nothing returns
  out_of_reach,     ///< unconfirmed: in the open chain the destination lies before the source
  given_up          ///< cancelled: by a reset, or because the sender or the daemon went away
};
constexpr Reason kLastReason = Reason::given_up;

/// One word for programs: "cpu_absent"; empty for none.
const char* to_string(Reason reason);
/// A clause for people: "no CPU is there"; empty for none.
const char* sentence(Reason reason);

}  // namespace limb_ring
