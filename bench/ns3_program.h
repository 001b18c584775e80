#pragma once

#include <cstdint>

namespace limb_ring::hops {

/// Whether bench_ns3_ring lies beside this program; it is built where ns-3 is installed.
bool ns3_installed();

/// One run of it.
/// @return packet-hops per second of wall-clock time, without the start of the program
/// @throw std::runtime_error where it fails
double ns3_ring(unsigned nodes, std::uint64_t hops);

}  // namespace limb_ring::hops
