#pragma once

#include <array>
#include <optional>

#include "recorder/record.h"

namespace limb_ring::recorder {

/// Reads what a RecordWriter has written, or anybody else. (ours)
class RecordReader {
 public:
  /// @param records must outlive this, and what is read
  /// @param last time of the record before the first
  RecordReader(wire::ByteView records, core::Time last) : records_(records), rest_(records), last_(last) {}

  /// True if all was read.
  bool complete() const { return rest_.complete(); }
  /// @return nothing where the bytes are no record, or one that no driver of a core would leave. Written::slices of a
  /// record is
  ///         there until two more have been read
  std::optional<Record> next();

 private:
  /// The time since the record before.
  core::Duration read_step(std::uint8_t tag);
  /// @param before the bytes before the record
  std::optional<Record> read(std::uint8_t tag, wire::ByteView before);
  bool read(Written& written, wire::ByteView before);
  bool read_slice(wire::SliceWriter& slices, wire::ByteView before);

  wire::ByteView records_;
  core::StateReader rest_;
  core::Time last_;
  std::array<wire::SliceWriter, 2> written_;
};

}  // namespace limb_ring::recorder
