#pragma once

#include <array>
#include <cstring>

#include "core/time.h"
#include "wire/data_packet.h"

namespace limb_ring::core {

/// The DATP that is coming in slice by slice. Receive needs it whole, since DID and CRC come last (ours); where Relay
/// passes it on, its bytes lie in the buffer in which that one waits, so that it is copied once.
class Incoming {
 public:
  bool open() const { return open_; }
  Time last_slice() const { return last_slice_; }
  /// With the HOP it came with; its HOP may have been counted up already for its way on.
  wire::ByteView bytes() {
    place_[wire::field::kHop] = hop_;
    return {place_, size_};
  }

  /// @param place room for the largest DATP, valid until it is closed; null: its own
  void begin(wire::ByteView bytes, Time now, std::uint8_t* place) {
    open_ = true;
    size_ = 0;
    hop_ = bytes[wire::field::kHop];
    place_ = place ? place : own_.data();
    append(bytes, now, wire::kMaxDataPacketSize);
  }
  /// @param most bytes of it that may have come in then
  /// @return false where it would be longer
  bool append(wire::ByteView bytes, Time now, std::size_t most) {
    if (size_ + bytes.size > most) return false;
    std::memcpy(place_ + size_, bytes.data, bytes.size);
    size_ += bytes.size;
    last_slice_ = now;
    return true;
  }
  void close() { open_ = false; }
  /// Where its bytes lie. @return the largest DATP has room
  std::uint8_t* place() { return place_; }

 private:
  bool open_ = false;
  std::uint8_t hop_ = 0;
  Time last_slice_{};
  std::size_t size_ = 0;
  std::array<std::uint8_t, wire::kMaxDataPacketSize> own_{};
  std::uint8_t* place_ = own_.data();
};

}  // namespace limb_ring::core
