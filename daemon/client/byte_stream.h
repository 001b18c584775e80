#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/errors.h"
#include "limb_ring/payload/packet_type.h"

namespace limb_ring::payload {

/// Appends big-endian fields.
class ByteWriter {
 public:
  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u16(std::uint16_t value);
  void u32(std::uint32_t value);
  void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
  void i64(std::int64_t value);
  void bytes(ByteView run) { bytes_.insert(bytes_.end(), run.begin(), run.end()); }
  void head(PacketType type);  ///< type and version

  std::uint8_t& at(std::size_t offset) { return bytes_[offset]; }
  std::size_t size() const { return bytes_.size(); }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::uint8_t* grow(std::size_t count);

  std::vector<std::uint8_t> bytes_;
};

/// Reads big-endian fields. Past the end every field reads as 0 and ended_early() turns true,
/// so that a format can be read in one go and judged once.
class ByteReader {
 public:
  explicit ByteReader(ByteView bytes) : rest_(bytes) {}

  std::uint8_t u8();
  std::uint16_t u16();
  std::uint32_t u32();
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  std::int64_t i64();
  ByteView bytes(std::size_t count);
  std::string text(std::size_t count);

  bool ended_early() const { return early_; }
  std::size_t left() const { return rest_.size; }
  /// What is wrong with the type and version; nothing if they are right.
  std::optional<DecodeError> head(PacketType type);
  /// What is wrong with the length, after the last field.
  std::optional<DecodeError> finish() const;

 private:
  const std::uint8_t* advance(std::size_t count);

  ByteView rest_;
  bool early_ = false;
};

}  // namespace limb_ring::payload
