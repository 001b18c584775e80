#pragma once

#include <stdexcept>

namespace limb_ring::ring_sim {

/// What ring_sim ends with; every --help says so too.
enum ExitCode : int {
  kDone = 0,
  /// A promise of the ring was broken, a plan does not fit onto it, two captures differ, gnuplot is missing or fails, a
  /// disk is full, or somebody has asked it to end before all was done.
  kBroken = 1,
  /// Wrong arguments, a configuration that is refused, or a folder that cannot be written.
  kUsage = 2
};

/// Of the help of a subcommand.
constexpr const char* kExitCodesInShort = "Exit code: 0 done, 1 broken promise or failure, 2 wrong arguments.";

constexpr const char* kExitCodesHelp =
    "Exit code: 0 done\n"
    "  1 a promise of the ring was broken, a plan does not fit onto it, two captures differ, gnuplot is missing or "
    "fails, a disk is full, or it was interrupted\n"
    "  2 wrong arguments or configuration, or a folder that cannot be written";

/// Ends ring_sim with kUsage.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace limb_ring::ring_sim
