#pragma once

#include <string>

namespace limb_ring::ringctl {

/// A line on standard error, for who has called ringctl: "ringctl: WHAT".
void tell_user(const std::string& what);

}  // namespace limb_ring::ringctl
