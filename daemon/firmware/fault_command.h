#pragma once

#include <optional>

#include "wire/bytes.h"

namespace limb_ring::firmware {

/// Trouble made on purpose, to see it cured: a user packet (channel 0) holding one of
///
///   hang      does nothing any more: reads nothing, says nothing, ignores SIGTERM
///   exit N    ends at once with exit code N, 0 to 255
struct FaultCommand {
  enum class Kind { hang, exit } kind = Kind::hang;
  int code = 0;
};

/// The order in a user packet's bytes (spaces and ends of line around it are left out); nothing
/// where it holds none.
std::optional<FaultCommand> parse_fault_command(wire::ByteView text);

}  // namespace limb_ring::firmware
