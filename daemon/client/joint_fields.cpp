#include "client/joint_fields.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "client/byte_stream.h"
#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"

namespace limb_ring::payload {
namespace {

using Joint = JointCommand::Joint;
constexpr std::size_t kFlagsAt = 16;  // in a packet
constexpr std::array<std::optional<double> Joint::*, 3> kFields{&Joint::position, &Joint::velocity, &Joint::effort};

std::uint8_t mask_of(const Joint& joint) {
  unsigned mask = 0;
  for (std::size_t i = 0; i < kFields.size(); ++i) mask |= unsigned{(joint.*kFields[i]).has_value()} << i;
  return static_cast<std::uint8_t>(mask);
}

}  // namespace

void put(ByteWriter& writer, PacketType type, const CommandHead& head) {
  writer.head(type);
  writer.u16(head.sequence);
  writer.i64(head.stamp_ns);
  writer.u32(head.valid_for_us);
  writer.u8(head.flags);
  writer.u8(head.count);
}

Decoded<CommandHead> get_head(ByteReader& reader, PacketType type, std::uint8_t known) {
  if (const auto wrong = reader.head(type)) return *wrong;
  CommandHead head;
  head.sequence = reader.u16();
  head.stamp_ns = reader.i64();
  head.valid_for_us = reader.u32();
  head.flags = reader.u8();
  head.count = reader.u8();
  if (reader.ended_early()) return DecodeError::truncated;
  if ((head.flags & ~known) != 0 || head.stamp_ns < 0) return DecodeError::bad_field;
  return head;
}

bool has_nan(const Joint& joint) {
  for (const auto field : kFields)
    if ((joint.*field) && std::isnan(*(joint.*field))) return true;
  return false;
}

std::size_t encoded_size(const Joint& joint) {
  const auto given =
      std::count_if(kFields.begin(), kFields.end(), [&](auto field) { return (joint.*field).has_value(); });
  return 1 + 4 * static_cast<std::size_t>(given);
}

void put(ByteWriter& writer, const Joint& joint) {
  writer.u8(mask_of(joint));
  for (const auto field : kFields) {
    if (!(joint.*field)) continue;
    const auto fixed = to_fixed(*(joint.*field), kMicro);
    writer.i32(fixed.steps);
    if (fixed.saturated) writer.at(kFlagsAt) |= kCommandSaturated;
  }
}

std::optional<DecodeError> get(ByteReader& reader, Joint& joint) {
  const auto mask = reader.u8();
  if (mask >> kFields.size() != 0) return DecodeError::bad_field;
  for (std::size_t i = 0; i < kFields.size(); ++i)
    if (mask >> i & 1) joint.*kFields[i] = from_fixed(reader.i32(), kMicro);
  if (reader.ended_early()) return DecodeError::truncated;
  return std::nullopt;
}

namespace {

std::optional<DecodeError> get_joints(ByteReader& reader, std::size_t count, JointCommand& command) {
  if (count > kMaxCommandJoints) return DecodeError::bad_count;
  command.joints.resize(count);
  for (auto& joint : command.joints)
    if (const auto wrong = get(reader, joint)) return wrong;
  return reader.finish();
}

}  // namespace

Encoded encode(const JointCommand& command) {
  if (command.joints.size() > kMaxCommandJoints) return EncodeFailure{EncodeError::too_many_items, kMaxCommandJoints};
  if (command.stamp_ns < 0) return EncodeFailure{EncodeError::bad_field, 0};
  ByteWriter writer;
  put(writer, PacketType::joint_command,
      {command.sequence, command.stamp_ns, command.valid_for_us, command.resume ? kResume : std::uint8_t{0},
       static_cast<std::uint8_t>(command.joints.size())});
  for (std::size_t i = 0; i < command.joints.size(); ++i) {
    if (has_nan(command.joints[i])) return EncodeFailure{EncodeError::not_a_number, i};
    put(writer, command.joints[i]);
  }
  return writer.take();
}

Decoded<JointCommand> decode_joint_command(ByteView packet) {
  ByteReader reader(packet);
  const auto head = get_head(reader, PacketType::joint_command, kResume | kCommandSaturated);
  if (!head) return head.error();
  JointCommand command;
  command.sequence = head->sequence;
  command.stamp_ns = head->stamp_ns;
  command.valid_for_us = head->valid_for_us;
  command.resume = (head->flags & kResume) != 0;
  command.saturated = (head->flags & kCommandSaturated) != 0;
  if (const auto wrong = get_joints(reader, head->count, command)) return *wrong;
  return command;
}

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

namespace {

bool is_twice(const CommandSet& set, std::size_t place) {
  const auto end = set.parts.begin() + static_cast<std::ptrdiff_t>(place);
  return std::any_of(set.parts.begin(), end, [&](const auto& part) { return part.node == set.parts[place].node; });
}

std::optional<EncodeError> wrong_at(const CommandSet& set, std::size_t place) {
  const CommandSet::Part& part = set.parts[place];
  if (part.joints.size() > kMaxCommandJoints) return EncodeError::too_many_items;
  if (is_twice(set, place)) return EncodeError::bad_field;
  if (std::any_of(part.joints.begin(), part.joints.end(), [](const auto& joint) { return has_nan(joint); }))
    return EncodeError::not_a_number;
  return std::nullopt;
}

void put(ByteWriter& writer, const CommandSet::Part& part) {
  writer.u8(part.node);
  writer.u8(static_cast<std::uint8_t>(part.joints.size()));
  for (const auto& joint : part.joints) put(writer, joint);
}

std::optional<DecodeError> get(ByteReader& reader, CommandSet::Part& part) {
  part.node = reader.u8();
  const std::size_t joints = reader.u8();
  if (joints > kMaxCommandJoints) return DecodeError::bad_count;
  part.joints.resize(joints);
  for (auto& joint : part.joints)
    if (const auto wrong = get(reader, joint)) return wrong;
  if (reader.ended_early()) return DecodeError::truncated;
  return std::nullopt;
}

}  // namespace

std::optional<JointCommand> CommandSet::to(std::uint8_t node) const {
  const auto part = std::find_if(parts.begin(), parts.end(), [node](const Part& each) { return each.node == node; });
  if (part == parts.end()) return std::nullopt;
  JointCommand command;
  command.sequence = sequence;
  command.stamp_ns = stamp_ns;
  command.valid_for_us = valid_for_us;
  command.saturated = saturated;
  command.joints = part->joints;
  return command;
}

std::size_t encoded_size(const CommandSet::Part& part) {
  std::size_t bytes = 2;
  for (const auto& joint : part.joints) bytes += encoded_size(joint);
  return bytes;
}

Encoded encode(const CommandSet& set) {
  if (set.stamp_ns < 0) return EncodeFailure{EncodeError::bad_field, 0};
  ByteWriter writer;
  put(writer, PacketType::command_set,
      {set.sequence, set.stamp_ns, set.valid_for_us, 0, static_cast<std::uint8_t>(set.parts.size())});
  for (std::size_t i = 0; i < set.parts.size(); ++i) {
    if (const auto wrong = wrong_at(set, i)) return EncodeFailure{*wrong, i};
    put(writer, set.parts[i]);
    if (writer.size() > kMaxPacket) return EncodeFailure{EncodeError::too_many_items, i};
  }
  return writer.take();
}

Decoded<CommandSet> decode_command_set(ByteView packet) {
  if (packet.size > kMaxPacket) return DecodeError::trailing_bytes;
  ByteReader reader(packet);
  const auto head = get_head(reader, PacketType::command_set, kCommandSaturated);
  if (!head) return head.error();
  CommandSet set;
  set.sequence = head->sequence;
  set.stamp_ns = head->stamp_ns;
  set.valid_for_us = head->valid_for_us;
  set.saturated = (head->flags & kCommandSaturated) != 0;
  set.parts.resize(head->count);
  for (std::size_t i = 0; i < set.parts.size(); ++i) {
    if (const auto wrong = get(reader, set.parts[i])) return *wrong;
    if (is_twice(set, i)) return DecodeError::bad_field;
  }
  if (const auto wrong = reader.finish()) return *wrong;
  return set;
}

Fixed to_fixed(double value, double steps_per_unit) {
  constexpr double kMost = 2147483647.0;  // the same on both sides, so that signs can be turned
  const double steps = std::round(value * steps_per_unit);
  if (std::fabs(steps) <= kMost) return {static_cast<std::int32_t>(steps), false};
  return {static_cast<std::int32_t>(steps < 0 ? -kMost : kMost), true};
}

namespace {

using Kind = SensorReading::Kind;
constexpr std::size_t kSensorFlagsAt = 13;
constexpr std::uint8_t kSensorSaturated = 1;

double resolution(Kind kind) { return kind == Kind::imu ? kMicro : kTenMicro; }

/// @return the first axis that is NaN
std::optional<std::size_t> nan_axis(const SensorReading& reading) {
  for (std::size_t i = 0; i < 6; ++i)
    if (std::isnan(i < 3 ? reading.linear[i] : reading.angular[i - 3])) return i;
  return std::nullopt;
}

void put(ByteWriter& writer, const std::array<double, 3>& axes, Kind kind) {
  for (double value : axes) {
    const auto fixed = to_fixed(value, resolution(kind));
    writer.i32(fixed.steps);
    if (fixed.saturated) writer.at(kSensorFlagsAt) |= kSensorSaturated;
  }
}

void get(ByteReader& reader, std::array<double, 3>& axes, Kind kind) {
  for (double& value : axes) value = from_fixed(reader.i32(), resolution(kind));
}

}  // namespace

Encoded encode(const SensorReading& reading) {
  if (reading.stamp_ns < 0) return EncodeFailure{EncodeError::bad_field, 0};
  if (const auto axis = nan_axis(reading)) return EncodeFailure{EncodeError::not_a_number, *axis};
  ByteWriter writer;
  writer.head(static_cast<PacketType>(reading.kind));
  writer.u16(reading.sequence);
  writer.i64(reading.stamp_ns);
  writer.u8(reading.sensor);
  writer.u8(0);
  writer.u16(0);
  put(writer, reading.linear, reading.kind);
  put(writer, reading.angular, reading.kind);
  return writer.take();
}

Decoded<SensorReading> decode_sensor_reading(ByteView packet) {
  ByteReader reader(packet);
  SensorReading reading;
  reading.kind = is_type(packet, PacketType::force) ? Kind::force : Kind::imu;
  if (const auto wrong = reader.head(static_cast<PacketType>(reading.kind))) return *wrong;
  reading.sequence = reader.u16();
  reading.stamp_ns = reader.i64();
  reading.sensor = reader.u8();
  const auto flags = reader.u8();
  const auto zero = reader.u16();
  get(reader, reading.linear, reading.kind);
  get(reader, reading.angular, reading.kind);
  if (const auto wrong = reader.finish()) return *wrong;
  const bool unknown = (flags & ~kSensorSaturated) != 0 || zero != 0;
  if (unknown || reading.stamp_ns < 0) return DecodeError::bad_field;
  reading.saturated = flags != 0;
  return reading;
}

}  // namespace limb_ring::payload
