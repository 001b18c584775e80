#pragma once

#include <array>
#include <cstdint>

#include "core/outcome.h"
#include "core/time.h"

namespace limb_ring::scenario {

/// What became of the sends of one name.
struct Tally {
  std::array<std::uint64_t, static_cast<std::size_t>(core::Outcome::cancelled) + 1> results{};  ///< by core::Outcome
  std::uint64_t taken = 0;  ///< by CPUs; of an interrupt, pins pulled
  core::Duration worst{0};  ///< from the request until it was confirmed, of what was delivered
};

}  // namespace limb_ring::scenario
