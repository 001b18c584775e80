#pragma once

#include <cstdint>

#include "wire/packet.h"

namespace limb_ring::core {

using wire::Outcome;
using wire::to_string;

/// Why a send was rejected; limb_ring/reason.h has the words.
enum class Reject : std::uint8_t {
  none,
  bad_size,
  bad_destination,
  bad_priority,
  bad_channel,
  bad_factor,
  input_unwired,
  queue_full,
  not_in_ring,
  no_way_out
};

}  // namespace limb_ring::core
