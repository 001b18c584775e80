#pragma once

#include <functional>
#include <string>

#include "core/time.h"
#include "judge/promise.h"

namespace limb_ring::sim {

using promises::Promise;
using promises::to_string;

/// A promise that was broken.
struct Violation {
  Promise promise;
  core::Time at;
  std::string what;  ///< the nodes and packets involved
};
using Complain = std::function<void(Promise, std::string what)>;

}  // namespace limb_ring::sim
