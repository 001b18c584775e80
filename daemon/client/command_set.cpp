#include "limb_ring/payload/command_set.h"

#include <algorithm>

#include "client/byte_stream.h"
#include "client/joint_fields.h"

namespace limb_ring::payload {
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

}  // namespace limb_ring::payload
