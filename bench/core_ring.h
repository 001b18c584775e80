#pragma once

#include <cstdint>

namespace limb_ring::hops {

/// The real core under the virtual clock, once it has joined, with all invariants checked or none.
/// @return packet-hops per second of wall-clock time, over at least `hops`
/// @throw std::runtime_error where an invariant was broken, or a packet not delivered
double core_ring(unsigned nodes, std::uint64_t hops, bool invariants);

}  // namespace limb_ring::hops
