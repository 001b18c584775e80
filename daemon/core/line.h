#pragma once

#include <cstdint>

namespace limb_ring::core {

/// A line of the ring: the first, which every ring has, or the second of a ring that folds back, which runs against it.
enum class Line : std::uint8_t { first, second };

}  // namespace limb_ring::core
