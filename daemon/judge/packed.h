#pragma once

#include <cstdint>
#include <cstring>

#include "wire/bytes.h"

namespace limb_ring::recorder {

/// Puts bytes one behind the other. What each packet causes is written by it and not by an archive, which asks for room
/// for each number. (ours)
class Packed {
 public:
  /// @param to room for all of it
  explicit Packed(std::uint8_t* to) : to_(to) {}
  template <class T>
  Packed& operator<<(T value) {
    std::memcpy(to_, &value, sizeof value);
    to_ += sizeof value;
    return *this;
  }
  Packed& operator<<(wire::ByteView all) {
    if (!all.empty()) std::memcpy(to_, all.data, all.size);
    to_ += all.size;
    return *this;
  }

 private:
  std::uint8_t* to_;
};

}  // namespace limb_ring::recorder
