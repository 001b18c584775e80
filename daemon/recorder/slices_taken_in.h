#pragma once

#include <array>
#include <cstdint>

#include "wire/slice.h"

namespace limb_ring::recorder {

/// The bytes of a slice that differ from another one's.
struct Differences {
  struct Byte {
    std::uint16_t place;
    std::uint8_t value;
  };
  /// HOP and CRC are 5 of them.
  std::array<Byte, 8> bytes;
  std::uint8_t count = 0;
};

/// The slices that a node has taken in last, as they lie in its recording. What it gives out is mostly one of them with
/// another HOP and another CRC. Finding that out takes less time than writing 500 bytes into memory that is in no
/// cache. (ours)
class SlicesTakenIn {
 public:
  /// @param recorded its bytes must stay where they are until forget()
  void add(const wire::Slice& recorded) { slices_[added_++ % slices_.size()] = recorded; }
  void forget() { first_ = added_; }
  /// Looks for one that `given_out` is but for a few bytes, in the order of arrival, behind the one that was found
  /// last.
  /// @param differences out: these bytes
  /// @return where its bytes lie; null: there is none, or `given_out` has no bytes
  const std::uint8_t* find(const wire::Slice& given_out, Differences& differences);

 private:
  std::array<wire::Slice, 32> slices_{};
  std::size_t added_ = 0;
  std::size_t first_ = 0;  ///< that may be found
};

}  // namespace limb_ring::recorder
