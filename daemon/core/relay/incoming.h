#pragma once

#include <algorithm>
#include <array>
#include <cstring>

#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::core {

/// The DATP that is coming in slice by slice. Receive needs it whole, since DID and CRC come last (ours). If Relay
/// passes it on, its bytes lie in its slot of the insertion buffer, so that they are copied only once.
class Incoming {
 public:
  bool open() const { return open_; }
  Time last_slice() const { return last_slice_; }
  /// Its bytes, with the HOP that it came with: in place, HOP may have been counted up already for the next node.
  wire::ByteView bytes() {
    place_[wire::field::kHop] = hop_;
    return {place_, size_};
  }

  /// @param place room for the largest DATP, valid until close(); null: use a buffer of its own
  void begin(wire::ByteView bytes, Time now, std::uint8_t* place) {
    open_ = true;
    size_ = 0;
    hop_ = bytes[wire::field::kHop];
    place_ = place ? place : own_.data();
    append(bytes, now, wire::kMaxDataPacketSize);
  }
  /// @param most bytes that it may have with these
  /// @return false if it would have more; nothing is added then
  bool append(wire::ByteView bytes, Time now, std::size_t most) {
    if (size_ + bytes.size > most) return false;
    std::memcpy(place_ + size_, bytes.data, bytes.size);
    size_ += bytes.size;
    last_slice_ = now;
    return true;
  }
  void close() { open_ = false; }
  /// Where its bytes lie; the largest DATP has room there.
  std::uint8_t* place() { return place_; }

  /// archive.h
  /// @param place where its bytes lie if it is passed on (PacketManager::receiving_place()); or null
  template <class Archive>
  void archive(Archive& a, std::uint8_t* place) {
    bool is_own = !open_ || place_ == own_.data() || place == nullptr;
    a("open", open_)("hop", hop_)("last_slice", last_slice_)("size", size_)("is_own", is_own);
    move_to(is_own || place == nullptr ? own_.data() : place);
    Bytes bytes{place_, open_ ? size_ : 0};
    a("bytes", bytes);
  }

 private:
  /// If the output was lost, the packet is not passed on any more, but its bytes still lie in its slot: moves them.
  void move_to(std::uint8_t* place) {
    if (open_ && place != place_) std::memcpy(place, place_, std::min(size_, wire::kMaxDataPacketSize));
    place_ = place;
  }
  /// The bytes that have come in, wherever they lie.
  struct Bytes {
    std::uint8_t* at;
    std::size_t size;
    template <class Archive>
    void archive(Archive& a) {
      for (std::size_t i = 0; i < std::min(size, wire::kMaxDataPacketSize); ++i) a("", at[i]);
    }
  };
  bool open_ = false;
  std::uint8_t hop_ = 0;
  Time last_slice_{};
  std::size_t size_ = 0;
  std::uint8_t* place_ = own_.data();
  std::array<std::uint8_t, wire::kMaxDataPacketSize> own_{};
};

}  // namespace limb_ring::core
