#pragma once

#include <cstdint>

namespace limb_ring::core {

/// How a send ended; every send has exactly one. (ours, protocol.md section 4.6)
enum class Outcome : std::uint8_t {
  delivered, refused, no_such_node, lost, unconfirmed, rejected, cancelled
};

/// One or three words: "no such node".
const char* to_string(Outcome outcome);

/// Why a send was rejected; limb_ring/reason.h has the words.
enum class Reject : std::uint8_t {
  none, bad_size, bad_destination, bad_priority, bad_channel, bad_factor, input_unwired, queue_full,
  not_in_ring, no_way_out
};

}  // namespace limb_ring::core
