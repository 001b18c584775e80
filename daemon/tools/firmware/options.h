#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>

namespace limb_ring::firmware {

/// What limb_firmware was told on its command line and by ringd.
struct Options {
  std::string ring;  ///< --ring, else LIMB_RING_RING, else that of --config, else the only one running
  std::string node;  ///< --node, else LIMB_RING_NODE: id or name
  std::optional<std::chrono::nanoseconds> hang_after;       ///< --hang-after
  std::optional<std::chrono::nanoseconds> endless_loop_at;  ///< --endless-loop-at, on the ring's virtual clock
  std::string command_log;                                  ///< --command-log; empty: none
  std::string print;                                        ///< to be printed instead of a run: --help, --version
};

/// what() names the argument and what would be right.
struct OptionsError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads the command line, and where it says nothing the environment that ringd gives its CPU.
/// @throw OptionsError
Options parse_options(int argc, const char* const* argv);

}  // namespace limb_ring::firmware
