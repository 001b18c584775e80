#pragma once

#include <cerrno>
#include <string>
#include <system_error>

namespace limb_ring::process {

/// @throw std::system_error of `what` and errno, always
[[noreturn]] inline void throw_errno(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// Of descriptors or memory, in this process or the system: it says nothing of what could not be opened for it.
inline bool is_shortage(int error) { return error == EMFILE || error == ENFILE || error == ENOMEM; }

}  // namespace limb_ring::process
