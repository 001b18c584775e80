#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>

#include "limb_ring/payload/byte_view.h"

namespace limb_ring::firmware {

/// Faults on demand, so that their cure can be tested: a user packet (channel 0) that holds one of
///
///   hang      does nothing any more: reads nothing, says nothing, ignores SIGTERM
///   exit N    ends at once with exit code N, 0 to 255
struct FaultCommand {
  enum class Kind { hang, exit } kind = Kind::hang;
  int code = 0;
};

/// The order in a user packet's bytes, without spaces and line ends around it; nothing if the
/// packet holds none.
std::optional<FaultCommand> parse_fault_command(payload::ByteView text);

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
