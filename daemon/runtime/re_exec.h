#pragma once

#include <sched.h>

#include <optional>

namespace limb_ring::runtime {

/// Starts the program of this process again in its place, with the same arguments, environment, pid and parent: for its
/// parent the process does not end. All descriptors but 0, 1 and 2 are closed.
/// @param cores that the new program may use; none: the same as this process
/// @throw std::system_error where the program cannot be executed (any more)
[[noreturn]] void re_exec(const std::optional<cpu_set_t>& cores);

}  // namespace limb_ring::runtime
