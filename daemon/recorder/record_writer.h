#pragma once

#include "recorder/record.h"
#include "recorder/slices_taken_in.h"

namespace limb_ring::recorder {

/// Writes records one behind the other (record_format.h). (ours)
class RecordWriter {
 public:
  /// @param room where they are written; must outlive this
  /// @param last time of the record before the first
  RecordWriter(core::StateWriter room, core::Time last) : room_(room), last_(last) {}

  /// @name Write one record
  /// @param at not before last()
  ///@{
  void put(core::Time at, const core::Input& input);
  void put(core::Time at, const Written& written);
  void put(core::Time at, const core::Event& event);
  void put(core::Time at, const core::ReceivedPacket& packet);
  ///@}

  /// A record had no room: it is not whole, and nothing was written since.
  bool failed() const { return room_.failed(); }
  /// Bytes in the room, also of what was there before the first record.
  std::size_t size() const { return room_.size(); }
  std::size_t left() const { return room_.left(); }
  /// Where the next record goes.
  const std::uint8_t* next() const { return room_.next(); }
  /// Time of the last record.
  core::Time last() const { return last_; }

 private:
  void begin(std::uint8_t tag, core::Time at);
  void put_receive(const core::input::Receive& call);
  void put_slice(const wire::Slice& slice);

  core::StateWriter room_;
  core::Time last_;
  SlicesTakenIn taken_in_;
  const std::uint8_t* begun_ = nullptr;  ///< the record that is being written
};

}  // namespace limb_ring::recorder
