#include "limb_ring/payload/fragment.h"

#include <algorithm>

#include "client/byte_stream.h"

namespace limb_ring::payload {
namespace {

/// Bytes that piece `index` of a message of `total` bytes holds.
std::size_t piece_size(const Fragment& fragment) {
  return std::min(kFragmentBytes, fragment.total - std::size_t{fragment.index} * kFragmentBytes);
}

std::optional<DecodeError> check(const Fragment& fragment) {
  if (fragment.total > kMaxMessage) return DecodeError::bad_field;
  if (fragment.count != fragment_count(fragment.total)) return DecodeError::bad_count;
  if (fragment.index >= fragment.count) return DecodeError::bad_field;
  const auto size = piece_size(fragment);
  if (fragment.bytes.size < size) return DecodeError::truncated;
  if (fragment.bytes.size > size) return DecodeError::trailing_bytes;
  return std::nullopt;
}

}  // namespace

std::uint32_t fnv1a(ByteView bytes) {
  std::uint32_t hash = 2166136261U;
  for (std::uint8_t byte : bytes) hash = (hash ^ byte) * 16777619U;
  return hash;
}

std::uint16_t fragment_count(std::size_t total) {
  const std::size_t pieces = (total + kFragmentBytes - 1) / kFragmentBytes;
  return static_cast<std::uint16_t>(std::max<std::size_t>(pieces, 1));
}

std::vector<std::uint8_t> encode(const Fragment& fragment) {
  ByteWriter writer;
  writer.head(PacketType::fragment);
  writer.u8(fragment.topic);
  writer.u8(static_cast<std::uint8_t>(fragment.kind));
  writer.u32(fragment.message);
  writer.u16(fragment.index);
  writer.u16(fragment.count);
  writer.u32(fragment.total);
  writer.u32(fragment.checksum);
  writer.bytes(fragment.bytes);
  return writer.take();
}

Decoded<Fragment> decode_fragment(ByteView packet) {
  ByteReader reader(packet);
  if (const auto wrong = reader.head(PacketType::fragment)) return *wrong;
  Fragment fragment;
  fragment.topic = reader.u8();
  const auto kind = reader.u8();
  fragment.message = reader.u32();
  fragment.index = reader.u16();
  fragment.count = reader.u16();
  fragment.total = reader.u32();
  fragment.checksum = reader.u32();
  if (reader.ended_early()) return DecodeError::truncated;
  if (kind > static_cast<std::uint8_t>(Fragment::Kind::data)) return DecodeError::bad_field;
  fragment.kind = static_cast<Fragment::Kind>(kind);
  fragment.bytes = reader.bytes(reader.left());
  if (const auto wrong = check(fragment)) return *wrong;
  return fragment;
}

}  // namespace limb_ring::payload
