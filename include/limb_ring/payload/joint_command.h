#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/expected.h"

namespace limb_ring::payload {

/// What a node's joints must do, from the body to its CPU, on channel 2. (ours)
///
///    0      1         2          4                12         16      17      18
///   | type | version | sequence | stamp           | valid_for | flags | count | joints ...
///   | 8    | 8       | 16       | 64, signed, ns  | 32, us    | 8     | 8     |
///
///   joint: | mask 8 | position i32, if bit 0 | velocity i32, if bit 1 | effort i32, if bit 2 |
///          in 1e-6 rad, rad/s, N m; of a joint that slides 1e-6 m, m/s, N
///   flags: bit 0 resume, bit 1 saturated
///
/// Joints are in the node's configured order; a joint with an empty mask, or beyond `count`, is
/// not commanded. 18 + 38 * 13 = 512 bytes: at most 38 joints.
struct JointCommand {
  struct Joint {
    std::optional<double> position;  ///< rad; m if it slides
    std::optional<double> velocity;  ///< rad/s or m/s; with a position: its rate (feed-forward)
    std::optional<double> effort;    ///< N m or N; with a position or velocity: added to the servo's
  };

  std::uint16_t sequence = 0;      ///< +1 for every command of this commander, wraps
  std::int64_t stamp_ns = 0;       ///< CLOCK_REALTIME when commanded, ns since 1970, not negative
  std::uint32_t valid_for_us = 0;  ///< not acted on later than stamp + valid_for
  bool resume = false;             ///< ends a latched stop; without joints it does only that
  bool saturated = false;          ///< read only: a value was out of range and cut to it
  std::vector<Joint> joints;
};

constexpr std::size_t kMaxCommandJoints = 38;

/// @return EncodeFailure naming the joint: not_a_number, too_many_items, bad_field (stamp)
Encoded encode(const JointCommand& command);
Decoded<JointCommand> decode_joint_command(ByteView packet);

}  // namespace limb_ring::payload
