#include "limb_ring/payload/joint_state.h"

#include <array>
#include <cmath>

#include "client/byte_stream.h"
#include "client/fixed_point.h"

namespace limb_ring::payload {
namespace {

using Mode = JointState::Mode;
constexpr std::size_t kModeAt = 12;
constexpr std::size_t kJointSize = 12;
constexpr std::uint8_t kSaturatedBit = 1 << 6;
constexpr std::array<bool Mode::*, 7> kModeBits{
    &Mode::commanded, &Mode::safe, &Mode::hold, &Mode::damp, &Mode::stopped, &Mode::command_refused, &Mode::saturated};
constexpr std::array<const char*, kModeBits.size()> kModeWords{"commanded",       "safe",     "hold", "damp", "stopped",
                                                               "command refused", "saturated"};

std::uint8_t to_bits(const Mode& mode) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < kModeBits.size(); ++i) bits |= unsigned{mode.*kModeBits[i]} << i;
  return static_cast<std::uint8_t>(bits);
}

Mode from_bits(std::uint8_t bits) {
  Mode mode;
  for (std::size_t i = 0; i < kModeBits.size(); ++i) mode.*kModeBits[i] = (bits >> i & 1) != 0;
  return mode;
}

bool has_nan(const JointState::Joint& joint) {
  return std::isnan(joint.position) || std::isnan(joint.velocity) || std::isnan(joint.effort);
}

void put(ByteWriter& writer, double value) {
  const auto fixed = to_fixed(value, kMicro);
  writer.i32(fixed.steps);
  if (fixed.saturated) writer.at(kModeAt) |= kSaturatedBit;
}

JointState::Joint get_joint(ByteReader& reader) {
  JointState::Joint joint;
  joint.position = from_fixed(reader.i32(), kMicro);
  joint.velocity = from_fixed(reader.i32(), kMicro);
  joint.effort = from_fixed(reader.i32(), kMicro);
  return joint;
}

}  // namespace

std::string to_string(const Mode& mode) {
  std::string text;
  for (std::size_t i = 0; i < kModeBits.size(); ++i)
    if (mode.*kModeBits[i]) text += (text.empty() ? "" : ", ") + std::string(kModeWords[i]);
  return text;
}

Encoded encode(const JointState& state) {
  if (state.joints.size() > kMaxStateJoints) return EncodeFailure{EncodeError::too_many_items, kMaxStateJoints};
  if (state.stamp_ns < 0) return EncodeFailure{EncodeError::bad_field, 0};
  ByteWriter writer;
  writer.head(PacketType::joint_state);
  writer.u16(state.sequence);
  writer.i64(state.stamp_ns);
  writer.u8(to_bits(state.mode));
  writer.u8(static_cast<std::uint8_t>(state.joints.size()));
  writer.u16(state.refused);
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    const auto& joint = state.joints[i];
    if (has_nan(joint)) return EncodeFailure{EncodeError::not_a_number, i};
    for (double value : {joint.position, joint.velocity, joint.effort}) put(writer, value);
  }
  return writer.take();
}

Decoded<JointState> decode_joint_state(ByteView packet) {
  ByteReader reader(packet);
  if (const auto wrong = reader.head(PacketType::joint_state)) return *wrong;
  JointState state;
  state.sequence = reader.u16();
  state.stamp_ns = reader.i64();
  const auto bits = reader.u8();
  const std::size_t count = reader.u8();
  state.refused = reader.u16();
  if (reader.ended_early()) return DecodeError::truncated;
  if (bits >> kModeBits.size() != 0 || state.stamp_ns < 0) return DecodeError::bad_field;
  if (count > kMaxStateJoints) return DecodeError::bad_count;
  if (reader.left() < count * kJointSize) return DecodeError::truncated;
  state.mode = from_bits(bits);
  for (std::size_t i = 0; i < count; ++i) state.joints.push_back(get_joint(reader));
  if (const auto wrong = reader.finish()) return *wrong;
  return state;
}

}  // namespace limb_ring::payload
