#pragma once

#include <sched.h>

#include <optional>

namespace limb_ring::runtime {

/// Starts the program of this process again in its place, with the same arguments, environment, pid and parent: for its
/// parent the process does not end. All descriptors but 0, 1 and 2 are closed.
/// Where it cannot be executed (any more), the process ends, with a line in its log: whoever looks after it starts it.
/// @param cores that the new program may use; none: the same as this process
[[noreturn]] void re_exec(const std::optional<cpu_set_t>& cores);

}  // namespace limb_ring::runtime
