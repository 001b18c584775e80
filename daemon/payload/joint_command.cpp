#include "limb_ring/payload/joint_command.h"

#include "payload/byte_stream.h"
#include "payload/joint_fields.h"

namespace limb_ring::payload {
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
  writer.head(PacketType::joint_command);
  writer.u16(command.sequence);
  writer.i64(command.stamp_ns);
  writer.u32(command.valid_for_us);
  writer.u8(command.resume ? kResume : std::uint8_t{0});
  writer.u8(static_cast<std::uint8_t>(command.joints.size()));
  for (std::size_t i = 0; i < command.joints.size(); ++i) {
    if (has_nan(command.joints[i])) return EncodeFailure{EncodeError::not_a_number, i};
    put(writer, command.joints[i]);
  }
  return writer.take();
}

Decoded<JointCommand> decode_joint_command(ByteView packet) {
  ByteReader reader(packet);
  if (const auto wrong = reader.head(PacketType::joint_command)) return *wrong;
  JointCommand command;
  command.sequence = reader.u16();
  command.stamp_ns = reader.i64();
  command.valid_for_us = reader.u32();
  const auto flags = reader.u8();
  const std::size_t count = reader.u8();
  if (reader.ended_early()) return DecodeError::truncated;
  if ((flags & ~(kResume | kCommandSaturated)) != 0 || command.stamp_ns < 0) return DecodeError::bad_field;
  command.resume = (flags & kResume) != 0;
  command.saturated = (flags & kCommandSaturated) != 0;
  if (const auto wrong = get_joints(reader, count, command)) return *wrong;
  return command;
}

}  // namespace limb_ring::payload
