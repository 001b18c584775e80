#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/expected.h"
#include "limb_ring/payload/joint_command.h"

namespace limb_ring::payload {

/// What the joints of several nodes must do: one broadcast on channel 2 instead of a JointCommand to each node. A node
/// has one packet under way at a time, so separate commands would take a lap each. (ours)
///
///    0      1         2          4                12         16      17      18
///   | type | version | sequence | stamp           | valid_for | flags | count | parts ...
///   | 8    | 8       | 16       | 64, signed, ns  | 32, us    | 8     | 8     |
///
///   part:  | node 8 | count 8 | joints, as in a JointCommand ... |
///   flags: bit 1 saturated
///
/// It does not resume from a stop. A node without a part is not commanded.
struct CommandSet {
  struct Part {
    std::uint8_t node = 0;  ///< id
    std::vector<JointCommand::Joint> joints;
  };

  std::uint16_t sequence = 0;  ///< as in a JointCommand, which these three are for all parts
  std::int64_t stamp_ns = 0;
  std::uint32_t valid_for_us = 0;
  bool saturated = false;   ///< read only: a value was out of range and cut to it
  std::vector<Part> parts;  ///< at most one for each node

  /// The command for that node; nothing if it has no part.
  std::optional<JointCommand> to(std::uint8_t node) const;
};

constexpr std::size_t kCommandSetHeader = 18;  ///< bytes before the parts

/// Size in bytes in a packet.
std::size_t encoded_size(const CommandSet::Part& part);
/// @return EncodeFailure naming the part: not_a_number, too_many_items (beyond 512 bytes), bad_field (stamp, node
/// twice)
Encoded encode(const CommandSet& set);
Decoded<CommandSet> decode_command_set(ByteView packet);

}  // namespace limb_ring::payload
