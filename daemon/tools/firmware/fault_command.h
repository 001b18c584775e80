#pragma once

#include <optional>

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

/// The order in a user packet's bytes, without spaces and line ends around it; nothing where the
/// packet holds none.
std::optional<FaultCommand> parse_fault_command(payload::ByteView text);

}  // namespace limb_ring::firmware
