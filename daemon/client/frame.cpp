#include "client/frame.h"

namespace limb_ring::client {

namespace {

constexpr std::size_t kSizeField = 4;
constexpr std::size_t kMaxText = 0xFFFF;

}  // namespace

FrameParse parse_frame(wire::ByteView bytes, std::size_t max_size) {
  if (bytes.size < kSizeField) return {FrameParse::Status::incomplete, {}, 0};
  const std::size_t size = wire::load_u32(bytes.data);
  if (size == 0 || size > max_size) return {FrameParse::Status::malformed, {}, 0};
  if (bytes.size - kSizeField < size) return {FrameParse::Status::incomplete, {}, 0};
  const Frame frame{bytes[kSizeField], bytes.first(kSizeField + size).from(kFrameHeaderSize)};
  return {FrameParse::Status::frame, frame, kSizeField + size};
}

FrameWriter::FrameWriter(Bytes& out, std::uint8_t type) : out_(out), start_(out.size()) {
  out_.resize(start_ + kSizeField);
  u8(type);
}

FrameWriter::~FrameWriter() {
  const std::size_t size = out_.size() - start_ - kSizeField;
  wire::store_u32(out_.data() + start_, static_cast<std::uint32_t>(size));
}

FrameWriter& FrameWriter::u8(std::uint8_t value) {
  out_.push_back(value);
  return *this;
}

FrameWriter& FrameWriter::u16(std::uint16_t value) {
  std::uint8_t bytes[2];
  wire::store_u16(bytes, value);
  return rest({bytes, sizeof bytes});
}

FrameWriter& FrameWriter::u32(std::uint32_t value) {
  std::uint8_t bytes[4];
  wire::store_u32(bytes, value);
  return rest({bytes, sizeof bytes});
}

FrameWriter& FrameWriter::u64(std::uint64_t value) {
  std::uint8_t bytes[8];
  wire::store_u64(bytes, value);
  return rest({bytes, sizeof bytes});
}

FrameWriter& FrameWriter::text(std::string_view value) {
  const std::string_view kept = value.substr(0, kMaxText);
  u16(static_cast<std::uint16_t>(kept.size()));
  return rest(kept);
}

FrameWriter& FrameWriter::rest(wire::ByteView bytes) {
  out_.insert(out_.end(), bytes.begin(), bytes.end());
  return *this;
}

FrameWriter& FrameWriter::rest(std::string_view text) {
  out_.insert(out_.end(), text.begin(), text.end());
  return *this;
}

wire::ByteView FieldReader::take(std::size_t size) {
  if (left_.size < size) {
    short_ = true;
    left_ = {};
    return {};
  }
  const wire::ByteView taken = left_.first(size);
  left_ = left_.from(size);
  return taken;
}

std::uint8_t FieldReader::u8() {
  const wire::ByteView bytes = take(1);
  return bytes.empty() ? std::uint8_t{0} : bytes[0];
}

std::uint16_t FieldReader::u16() {
  const wire::ByteView bytes = take(2);
  return bytes.empty() ? std::uint16_t{0} : wire::load_u16(bytes.data);
}

std::uint32_t FieldReader::u32() {
  const wire::ByteView bytes = take(4);
  return bytes.empty() ? 0 : wire::load_u32(bytes.data);
}

std::uint64_t FieldReader::u64() {
  const wire::ByteView bytes = take(8);
  return bytes.empty() ? 0 : wire::load_u64(bytes.data);
}

std::string_view FieldReader::text() { return as_text(take(u16())); }

wire::ByteView FieldReader::rest() { return take(left_.size); }

std::string_view FieldReader::rest_text() { return as_text(rest()); }

}  // namespace limb_ring::client
