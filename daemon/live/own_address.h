#pragma once

#include <string>

namespace limb_ring::live {

/// Whether a process of this machine can listen at that address, in numbers: it is one of its own. (ours)
bool is_own_address(const std::string& address);

}  // namespace limb_ring::live
