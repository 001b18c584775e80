#include "client/joint_fields.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "client/fixed_point.h"

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

}  // namespace limb_ring::payload
