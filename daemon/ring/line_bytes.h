#pragma once

#include <algorithm>
#include <cstdint>

#include "wire/slice.h"

namespace limb_ring::ask {

/// Bytes that the line into a node has carried: what came in without the framing of the link, which is no part of the
/// ring's data rate.
/// @param counter value of a node's counter, by its name
template <class Counter>
std::uint64_t line_bytes_in(Counter counter) {
  const std::uint64_t all = counter("input_bytes");
  const std::uint64_t framing = wire::kSliceHeaderSize * (counter("input_slices") + counter("input_idle_slices"));
  return all - std::min(all, framing);
}

}  // namespace limb_ring::ask
