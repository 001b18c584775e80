#pragma once

#include <stdexcept>
#include <string>

#include "ring/not_done.h"

namespace limb_ring::ringctl {

/// What ringctl ends with; every --help says so too.
enum ExitCode : int {
  kDone = 0,
  kNotDone = 1,  ///< the thing asked for did not happen
  kUsage = 2,    ///< wrong arguments, or a configuration that is refused
  kNoRing = 3,   ///< no such ring, or a daemon that does not answer
  kUnknown = 4   ///< sent, but nobody knows whether it has happened
};

/// Of the help of a subcommand.
constexpr const char* kExitCodesInShort =
    "Exit code: 0 done, 1 not done, 2 wrong arguments, 3 no ring, 4 nobody knows.";

constexpr const char* kExitCodesHelp =
    "Exit code: 0 done\n"
    "  1 it did not happen: not delivered, ring not closed in time ...\n"
    "  2 wrong arguments or configuration\n"
    "  3 no such ring, or its daemon does not answer\n"
    "  4 sent, and nobody knows if it happened: open ring, or lost on the way home";

/// Ends ringctl with kNotDone.
using live::NotDone;

/// The user wants no more of it: ends ringctl with kNotDone.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

/// It was asked for, and may still happen: ends ringctl with kUnknown.
struct NotKnown : std::runtime_error {
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

/// Only daemons of another host can do it: ends ringctl with kNoRing, or it is done there (--ssh).
struct Elsewhere : NoRing {
  Elsewhere(const std::string& what, std::string ssh_destination, std::string of_ring = {})
      : NoRing(what), destination(std::move(ssh_destination)), ring(std::move(of_ring)) {}
  std::string destination;  ///< as ssh takes it
  std::string ring;         ///< empty where no ring runs yet
};

}  // namespace limb_ring::ringctl
