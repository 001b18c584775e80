#pragma once

#include <string>

namespace limb_ring::live {

/// Whether `address`, which must be numeric, is this machine's own: a process here can bind to it. (ours)
bool is_own_address(const std::string& address);

}  // namespace limb_ring::live
