#include "limb_ring/payload/joint_command.h"

#include "client/byte_stream.h"
#include "client/joint_fields.h"

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

}  // namespace limb_ring::payload
