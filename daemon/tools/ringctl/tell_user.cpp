#include "tools/ringctl/tell_user.h"

#include <iostream>

namespace limb_ring::ringctl {

void tell_user(const std::string& what) { std::cerr << "ringctl: " << what << std::endl; }

}  // namespace limb_ring::ringctl
