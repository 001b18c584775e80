#pragma once

namespace limb_ring::runtime {

/// This process becomes a fresh one of its own program, with the arguments, surroundings, pid and parent it
/// has: whoever watches over it sees no end. All descriptors but 0, 1 and 2 are closed.
/// @throw std::system_error where the program cannot be executed (any more)
[[noreturn]] void begin_anew();

}  // namespace limb_ring::runtime
