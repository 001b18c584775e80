#pragma once

#include <chrono>
#include <cstdint>

#include "limb_ring/host_port.h"
#include "limb_ring/payload/joint_command.h"

namespace limb_ring::ask {

/// The command that ends a latched stop. (limb_ring/payload/joint_command.h) It is valid for 1 s, longer than others,
/// since a hung CPU may take so long to read it. (ours)
/// @param stamp_ns when it was given, by the clock of payloads
payload::JointCommand resume_command(std::int64_t stamp_ns);

/// Sends resume_command() to the CPU of one node, and waits for its result. Whether the CPU obeys it,
/// wait_for_resumes() tells (known_stops.h).
/// @throw HostPortError on time-out
Result resume_cpu(HostPort& port, std::uint8_t node, std::chrono::milliseconds timeout);

}  // namespace limb_ring::ask
