#pragma once

#include <cstdint>

namespace limb_ring {

/// Why a send ended otherwise than delivered. (ours) The first ten are known before anything is sent; of the others
/// the source knows what its own ring's file and the others' beacons say.
enum class Reason : std::uint8_t {
  none,  ///< delivered
  bad_size,
  bad_destination,
  bad_priority,
  bad_channel,
  bad_factor,
  input_unwired,
  queue_full,
  not_in_ring,
  no_way_out,
  needs_force,   ///< rejected: it would reset every CPU at once
  cpu_absent,    ///< refused: the destination is to have a CPU, and none is there
  cpu_booting,   ///< refused: its CPU boots
  cpu_failed,    ///< refused: its CPU has failed
  cpu_silent,    ///< refused: its CPU hangs and takes nothing out of the receive buffers
  no_buffer,     ///< refused: no receive buffer of that priority is free
  joining,       ///< refused: the destination is joining the ring
  pin_unwired,   ///< refused: the pin is wired to nothing there
  node_missing,  ///< no such node: it is down or bypassed
  no_return,     ///< lost: no try came home whole in time
  open_chain,    ///< unconfirmed: the ring is open, and nothing returns
  out_of_reach,  ///< unconfirmed: in the open chain the destination lies before the source
  given_up       ///< cancelled: by a reset, or because the sender or the daemon went away
};
constexpr Reason kLastReason = Reason::given_up;

/// One word for programs: "cpu_absent"; empty for none.
const char* to_string(Reason reason);
/// A clause for people: "no CPU is there"; empty for none.
const char* sentence(Reason reason);

}  // namespace limb_ring
