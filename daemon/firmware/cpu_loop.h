#pragma once

#include <chrono>
#include <optional>

#include "firmware/node_cpu.h"
#include "limb_ring/host_port.h"

namespace limb_ring::firmware {

/// Of the ring.
Timestamps read_clocks(const HostPort& port);

/// Runs the CPU on its host port until a stop signal, an order, or the end of the connection. The
/// daemon hears from it four times per `alive_period`, however idle it is.
/// @return exit code
int run(HostPort& port, NodeCpu& cpu, nanoseconds alive_period, std::optional<nanoseconds> hang_after);

}  // namespace limb_ring::firmware
