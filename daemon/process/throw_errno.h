#pragma once

#include <cerrno>
#include <string>
#include <system_error>

namespace limb_ring::process {

/// @throw std::system_error of `what` and errno, always
[[noreturn]] inline void throw_errno(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace limb_ring::process
