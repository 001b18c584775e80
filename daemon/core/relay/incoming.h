#pragma once

#include <array>
#include <cstring>

#include "core/relay/relay.h"
#include "wire/data_packet.h"

namespace limb_ring::core {

/// The DATP that is coming in slice by slice, as Receive sees it. Receive fills a buffer
/// speculatively, since DID and CRC come last (ours); where Relay passes the packet on, it is the
/// buffer in which that one waits, so that it is copied once.
class Incoming {
 public:
  bool open() const { return open_; }
  Relay::Fate fate() const { return fate_; }
  Time last_slice() const { return last_slice_; }
  /// As it came: on its way on, its HOP may have been counted up already.
  wire::ByteView bytes() {
    place_[2] = hop_;
    return {place_, size_};
  }

  /// @param place room for the largest DATP, valid until it is closed; null: its own
  void begin(Relay::Fate fate, wire::ByteView bytes, Time now, std::uint8_t* place) {
    open_ = true;
    fate_ = fate;
    size_ = 0;
    hop_ = bytes[2];
    place_ = place ? place : own_.data();
    append(bytes, now);
  }
  /// @param most bytes of it that may have come in then
  /// @return false where it would be longer
  bool append(wire::ByteView bytes, Time now, std::size_t most = wire::kMaxDataPacketSize) {
    if (size_ + bytes.size > most) return false;
    std::memcpy(place_ + size_, bytes.data, bytes.size);
    size_ += bytes.size;
    last_slice_ = now;
    return true;
  }
  void close() { open_ = false; }

 private:
  bool open_ = false;
  Relay::Fate fate_ = Relay::Fate::discard;
  std::uint8_t hop_ = 0;
  Time last_slice_{};
  std::size_t size_ = 0;
  std::uint8_t* place_ = own_.data();
  std::array<std::uint8_t, wire::kMaxDataPacketSize> own_{};
};

}  // namespace limb_ring::core
