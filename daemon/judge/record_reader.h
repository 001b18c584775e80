#pragma once

#include <array>
#include <optional>

#include "judge/record.h"

namespace limb_ring::recorder {

/// Reads what a RecordWriter has written, or anybody else. (ours)
class RecordReader {
 public:
  /// @param records must outlive this, and what is read
  /// @param last time of the record before the first
  RecordReader(wire::ByteView records, core::Time last) : rest_(records), last_(last) {}

  /// True if all was read.
  bool complete() const { return rest_.complete(); }
  /// @return nothing where the bytes are no record, or one that no driver of a core would leave. The bytes of a packet
  ///         whose data was left out are there until the next record is read
  std::optional<Record> next();

 private:
  /// The time since the record before.
  core::Duration read_step(std::uint8_t tag);
  std::optional<Record> read(std::uint8_t tag);
  /// @return false where it is none
  bool read(core::input::Receive& call, bool& data_left_out);
  bool read_abridged(wire::Slice& slice, std::uint32_t size);

  core::StateReader rest_;
  core::Time last_;
  std::array<std::uint8_t, wire::kMaxDataPacketSize> packet_{};  ///< whose data was left out
};

}  // namespace limb_ring::recorder
