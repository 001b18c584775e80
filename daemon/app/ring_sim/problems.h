#pragma once

#include <stdexcept>

namespace limb_ring::ring_sim {

/// What ring_sim ends with; every --help says so too.
enum ExitCode : int {
  kDone = 0,
  kBroken = 1,  ///< a promise of the ring was broken, a plan does not fit onto it, or gnuplot is missing or fails
  kUsage = 2    ///< wrong arguments, a configuration that is refused, or a folder that cannot be written
};

constexpr const char* kExitCodesHelp =
    "Exit code: 0 done; 1 a promise of the ring was broken, a plan does not fit onto it, or gnuplot is missing "
    "or fails; 2 wrong arguments or configuration, or a folder that cannot be written.";

/// Ends ring_sim with kUsage.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace limb_ring::ring_sim
