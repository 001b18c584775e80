#pragma once

#include "bench/measurement.h"
#include "bench/setup.h"

namespace limb_ring::bench {

/// What the kernel alone takes: as many processes in a ring of UNIX stream sockets, each reading
/// what came (up to 64 KiB) and writing it downstream, blocking, with no protocol. The packets are
/// as long as the ring's own. A sender knows its packet by its first byte, times its lap, and lets
/// it go round again. (ours)
/// @throw std::runtime_error where it does not go round
Measurement measure_reference(const Setup& setup, Pinning pinning, Sending sending);

}  // namespace limb_ring::bench
