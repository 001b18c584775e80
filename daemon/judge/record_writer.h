#pragma once

#include "judge/record.h"

namespace limb_ring::recorder {

/// Writes records one behind the other (record_format.h). (ours)
class RecordWriter {
 public:
  /// @param room where they are written; must outlive this
  /// @param last time of the record before the first
  RecordWriter(core::StateWriter room, core::Time last) : room_(room), last_(last) {}

  /// @name Write one record. Of packets that only pass the node, the data is left out.
  /// @param at not before last()
  ///@{
  void put(core::Time at, const core::Input& input);
  void put(core::Time at, const Written& written);
  /// As a Written has them.
  void put_written(core::Time at, core::Line line, wire::ByteView framed_slices);
  void put(core::Time at, const core::Event& event);
  void put(core::Time at, const Taken& packet);
  ///@}

  /// A record had no room: it is not whole, and nothing was written since.
  bool failed() const { return room_.failed(); }
  /// Bytes in the room, also of what was there before the first record.
  std::size_t size() const { return room_.size(); }
  std::size_t left() const { return room_.left(); }
  /// Where the next record goes.
  const std::uint8_t* next() const { return room_.next(); }
  /// Data was left out of one of the records.
  bool left_out() const { return left_out_; }
  /// Time of the last record.
  core::Time last() const { return last_; }

 private:
  /// Begins a record. @return where its next `size` bytes go; null where there is no room
  std::uint8_t* begin(std::uint8_t tag, core::Time at, std::size_t size = 0);
  void put_receive(std::uint8_t tag, core::Time at, const core::input::Receive& call);

  core::StateWriter room_;
  core::Time last_;
  bool left_out_ = false;
};

}  // namespace limb_ring::recorder
