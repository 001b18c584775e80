#pragma once

#include <chrono>
#include <optional>

#include "firmware/node_cpu.h"
#include "limb_ring/host_port.h"

namespace limb_ring::firmware {

/// The promise to the daemon: something is heard of this CPU at least so often.
constexpr std::chrono::milliseconds kAlivePeriod{200};

Moment read_clocks();

/// Runs the CPU on its host port until a stop signal, an order, or the end of the connection.
/// @return exit code
int run(HostPort& port, NodeCpu& cpu, std::optional<nanoseconds> hang_after);

}  // namespace limb_ring::firmware
