#pragma once

#include <sched.h>

#include <optional>

namespace limb_ring::runtime {

/// This process becomes a fresh one of its own program, with the arguments, surroundings, pid and parent it
/// has: whoever watches over it sees no end. All descriptors but 0, 1 and 2 are closed.
/// @param cores it may use, where this process has pinned itself since; else as this process
/// @throw std::system_error where the program cannot be executed (any more)
[[noreturn]] void re_exec(const std::optional<cpu_set_t>& cores);

}  // namespace limb_ring::runtime
