#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/expected.h"

namespace limb_ring::payload {

/// What a node's joints do, from its CPU to the body, on channel 2. (ours)
///
///    0      1         2          4                12     13      14         16
///   | type | version | sequence | stamp           | mode | count | refused  | joints ...
///   | 8    | 8       | 16       | 64, signed, ns  | 8    | 8     | 16       |
///
///   joint (12 B): | position i32, 1e-6 rad | velocity i32, 1e-6 rad/s | effort i32, 1e-6 N m |
///   mode bits:    0 commanded  1 safe  2 hold  3 damp  4 stopped  5 command_refused  6 saturated
///
/// For a joint that slides (prismatic) m, m/s and N stand for rad, rad/s and N m, with the same step of 1e-6: 1 um, and
/// at most 2147 m. The packet does not say which it is: the ring's file does.
///
/// Joints are in the node's configured order. 16 + 41 * 12 = 508 bytes: at most 41 joints.
struct JointState {
  struct Mode {
    bool commanded = false;        ///< at least one joint obeys a command
    bool safe = false;             ///< at least one joint is in its safe state
    bool hold = false;             ///< ... and holds its position
    bool damp = false;             ///< ... and lets its velocity decay
    bool stopped = false;          ///< a stop interrupt is latched until a command resumes
    bool command_refused = false;  ///< a command was stale or unfit since the last state
    bool saturated = false;        ///< a value of this packet was out of range and cut to it
  };
  struct Joint {
    double position = 0;  ///< rad; m if it slides
    double velocity = 0;  ///< rad/s; m/s
    double effort = 0;    ///< N m; N
  };

  std::uint16_t sequence = 0;  ///< +1 for every state of this CPU, wraps
  std::int64_t stamp_ns = 0;   ///< CLOCK_REALTIME when sampled, ns since 1970, not negative
  Mode mode;
  std::uint16_t refused = 0;  ///< commands refused since the CPU's start, wraps
  std::vector<Joint> joints;
};

constexpr std::size_t kMaxStateJoints = 41;

/// "safe, hold, command refused"; empty if nothing is set.
std::string to_string(const JointState::Mode& mode);

/// Sets `mode.saturated` in the bytes if a value had to be clamped.
/// @return EncodeFailure naming the joint: not_a_number, too_many_items, bad_field (stamp)
Encoded encode(const JointState& state);
Decoded<JointState> decode_joint_state(ByteView packet);

}  // namespace limb_ring::payload
