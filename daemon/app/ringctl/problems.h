#pragma once

#include <stdexcept>

namespace limb_ring::ringctl {

/// What ringctl ends with; every --help says so too.
enum ExitCode : int {
  kDone = 0,
  kNotDone = 1,  ///< the thing asked for did not happen
  kUsage = 2,    ///< wrong arguments, or a configuration that is refused
  kNoRing = 3    ///< no such ring, or a daemon that does not answer
};

constexpr const char* kExitCodesHelp =
    "Exit code: 0 done; 1 it did not happen (not delivered, ring not closed in time ...); "
    "2 wrong arguments or configuration; 3 no such ring, or its daemon does not answer.";

/// Ends ringctl with kNotDone.
struct NotDone : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Ends ringctl with kUsage.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Ends ringctl with kNoRing, as limb_ring::HostPortError does.
struct NoRing : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace limb_ring::ringctl
