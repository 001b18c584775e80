#pragma once

#include <chrono>
#include <cstdint>

#include "limb_ring/host_port.h"

namespace limb_ring::ask {

/// How long the command that ends a latched stop is valid: longer than others, since a hung CPU may take so long to
/// read it. (ours)
constexpr std::chrono::microseconds kResumeValidFor = std::chrono::seconds(1);

/// Sends the command that ends a latched stop to the CPU of one node, and waits for its result.
/// (limb_ring/payload/joint_command.h) Whether the CPU obeys it, wait_for_resumes() tells (known_stops.h).
/// @throw HostPortError on time-out
Result resume_cpu(HostPort& port, std::uint8_t node, std::chrono::milliseconds timeout);

}  // namespace limb_ring::ask
