#pragma once

#include <stdexcept>

namespace limb_ring::live {

/// What was asked of a ring did not happen; what() says why.
struct NotDone : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace limb_ring::live
