#pragma once

#include <chrono>
#include <cstdint>

#include "limb_ring/host_port.h"

namespace limb_ring::ask {

/// Sends the command that ends a latched stop to the CPU of one node, and waits for its result.
/// (limb_ring/payload/joint_command.h)
/// @throw HostPortError on time-out
Result resume_cpu(HostPort& port, std::uint8_t node, std::chrono::milliseconds timeout);

}  // namespace limb_ring::ask
