#pragma once

#include <stdexcept>

namespace limb_ring::ring_sim {

/// What ring_sim ends with; every --help says so too.
enum ExitCode : int {
  kDone = 0,
  kBroken = 1,  ///< a promise of the ring was broken, or a plan does not fit onto it
  kUsage = 2    ///< wrong arguments, or a configuration that is refused
};

constexpr const char* kExitCodesHelp =
    "Exit code: 0 done; 1 a promise of the ring was broken, or a plan does not fit onto it; "
    "2 wrong arguments or configuration.";

/// Ends ring_sim with kUsage.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace limb_ring::ring_sim
