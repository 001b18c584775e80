#include "client/byte_stream.h"

#include "limb_ring/payload/errors.h"
#include "wire/bytes.h"

namespace limb_ring::payload {

std::uint8_t* ByteWriter::grow(std::size_t count) {
  bytes_.resize(bytes_.size() + count);
  return bytes_.data() + bytes_.size() - count;
}

void ByteWriter::u16(std::uint16_t value) { wire::store_u16(grow(2), value); }
void ByteWriter::u32(std::uint32_t value) { wire::store_u32(grow(4), value); }
void ByteWriter::i64(std::int64_t value) { wire::store_u64(grow(8), static_cast<std::uint64_t>(value)); }

void ByteWriter::head(PacketType type) {
  u8(static_cast<std::uint8_t>(type));
  u8(kVersion);
}

const std::uint8_t* ByteReader::advance(std::size_t count) {
  if (early_ || rest_.size < count) {
    early_ = true;
    rest_ = {};
    return nullptr;
  }
  const std::uint8_t* at = rest_.data;
  rest_ = {rest_.data + count, rest_.size - count};
  return at;
}

std::uint8_t ByteReader::u8() {
  const auto* p = advance(1);
  return p ? *p : std::uint8_t{0};
}
std::uint16_t ByteReader::u16() {
  const auto* p = advance(2);
  return p ? wire::load_u16(p) : std::uint16_t{0};
}
std::uint32_t ByteReader::u32() {
  const auto* p = advance(4);
  return p ? wire::load_u32(p) : 0U;
}
std::int64_t ByteReader::i64() {
  const auto* p = advance(8);
  return p ? static_cast<std::int64_t>(wire::load_u64(p)) : std::int64_t{0};
}

ByteView ByteReader::bytes(std::size_t count) {
  const auto* p = advance(count);
  return p ? ByteView{p, count} : ByteView{};
}

std::string ByteReader::text(std::size_t count) {
  const auto run = bytes(count);
  return {run.begin(), run.end()};
}

std::optional<DecodeError> ByteReader::head(PacketType type) {
  const auto found = u8();
  const auto version = u8();
  if (early_) return DecodeError::truncated;
  if (found != static_cast<std::uint8_t>(type)) return DecodeError::wrong_type;
  if (version != kVersion) return DecodeError::wrong_version;
  return std::nullopt;
}

std::optional<DecodeError> ByteReader::finish() const {
  if (early_) return DecodeError::truncated;
  if (rest_.size != 0) return DecodeError::trailing_bytes;
  return std::nullopt;
}

const char* to_string(DecodeError error) {
  switch (error) {
    case DecodeError::truncated:
      return "ends before its last field";
    case DecodeError::trailing_bytes:
      return "goes on after its last field";
    case DecodeError::wrong_type:
      return "is of another type";
    case DecodeError::wrong_version:
      return "is of a version not known here";
    case DecodeError::bad_count:
      return "has a number of items that the format does not allow";
    case DecodeError::bad_field:
      return "has a field with a value that means nothing";
  }
  return "unknown error";
}

static const char* sentence(EncodeError error) {
  switch (error) {
    case EncodeError::not_a_number:
      return "is not a number";
    case EncodeError::too_many_items:
      return "no longer fits into one packet of 512 bytes";
    case EncodeError::too_large:
      return "is longer than the format allows";
    case EncodeError::bad_field:
      return "has a value that the format cannot express";
  }
  return "unknown error";
}

std::string to_string(const EncodeFailure& failure) {
  return "item " + std::to_string(failure.item) + ": " + sentence(failure.error);
}

}  // namespace limb_ring::payload
