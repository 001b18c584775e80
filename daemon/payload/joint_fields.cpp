#include "payload/joint_fields.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "payload/fixed_point.h"

namespace limb_ring::payload {
namespace {

using Joint = JointCommand::Joint;
constexpr std::array<std::optional<double> Joint::*, 3> kFields{&Joint::position, &Joint::velocity, &Joint::effort};

std::uint8_t mask_of(const Joint& joint) {
  unsigned mask = 0;
  for (std::size_t i = 0; i < kFields.size(); ++i) mask |= unsigned{(joint.*kFields[i]).has_value()} << i;
  return static_cast<std::uint8_t>(mask);
}

}  // namespace

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
    if (fixed.saturated) writer.at(kCommandFlagsAt) |= kCommandSaturated;
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
