#pragma once

#include <array>
#include <cstring>

#include "core/relay.h"
#include "wire/data_packet.h"

namespace limb_ring::core {

/// The DATP that is coming in slice by slice, as Receive sees it. Receive fills a buffer
/// speculatively, since DID and CRC come last. (ours)
class Incoming {
 public:
  bool open() const { return open_; }
  Relay::Fate fate() const { return fate_; }
  Time last_slice() const { return last_slice_; }
  wire::ByteView bytes() const { return {bytes_.data(), size_}; }

  void begin(Relay::Fate fate, wire::ByteView bytes, Time now) {
    open_ = true;
    fate_ = fate;
    size_ = 0;
    append(bytes, now);
  }
  /// @return false where it would be longer than any DATP
  bool append(wire::ByteView bytes, Time now) {
    if (size_ + bytes.size > bytes_.size()) return false;
    std::memcpy(bytes_.data() + size_, bytes.data, bytes.size);
    size_ += bytes.size;
    last_slice_ = now;
    return true;
  }
  void close() { open_ = false; }

 private:
  bool open_ = false;
  Relay::Fate fate_ = Relay::Fate::discard;
  Time last_slice_{};
  std::size_t size_ = 0;
  std::array<std::uint8_t, wire::kMaxDataPacketSize> bytes_{};
};

}  // namespace limb_ring::core
