#include "limb_ring/payload/announcement.h"

#include <tuple>

#include "client/byte_stream.h"
#include "limb_ring/payload/fragment.h"

namespace limb_ring::payload {
namespace {

constexpr std::uint8_t kLatching = 1;

ByteView view(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

void put_short(ByteWriter& writer, const std::string& text) {
  writer.u16(static_cast<std::uint16_t>(text.size()));
  writer.bytes(view(text));
}

auto tie(const Announcement& a) { return std::tie(a.name, a.datatype, a.md5sum, a.definition, a.latching); }

}  // namespace

bool Announcement::operator==(const Announcement& other) const { return tie(*this) == tie(other); }

Encoded encode(const Announcement& announcement) {
  std::size_t item = 0;
  for (const auto* text : {&announcement.name, &announcement.datatype, &announcement.md5sum}) {
    if (text->size() > 0xFFFF) return EncodeFailure{EncodeError::too_large, item};
    ++item;
  }
  if (announcement.definition.size() > kMaxMessage / 2) return EncodeFailure{EncodeError::too_large, item};
  ByteWriter writer;
  writer.u8(kVersion);
  writer.u8(announcement.latching ? kLatching : std::uint8_t{0});
  put_short(writer, announcement.name);
  put_short(writer, announcement.datatype);
  put_short(writer, announcement.md5sum);
  writer.u32(static_cast<std::uint32_t>(announcement.definition.size()));
  writer.bytes(view(announcement.definition));
  return writer.take();
}

Decoded<Announcement> decode_announcement(ByteView message) {
  ByteReader reader(message);
  const auto version = reader.u8();
  const auto flags = reader.u8();
  if (reader.ended_early()) return DecodeError::truncated;
  if (version != kVersion) return DecodeError::wrong_version;
  if ((flags & ~kLatching) != 0) return DecodeError::bad_field;
  Announcement announcement;
  announcement.latching = flags != 0;
  announcement.name = reader.text(reader.u16());
  announcement.datatype = reader.text(reader.u16());
  announcement.md5sum = reader.text(reader.u16());
  announcement.definition = reader.text(reader.u32());
  if (const auto wrong = reader.finish()) return *wrong;
  // What ROS takes for any type, or for none, cannot be published.
  for (const std::string& text : {announcement.datatype, announcement.md5sum})
    if (text.empty() || text == "*") return DecodeError::bad_field;
  return announcement;
}

}  // namespace limb_ring::payload
