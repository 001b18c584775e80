#pragma once

#include <array>
#include <cstdint>

#include "wire/slice.h"

namespace limb_ring::recorder {

/// How a slice differs from another one of its size: in some words of 8 bytes at its ends. HOP lies in the first 16
/// bytes, FBC and CRC in the last 16. They are taken as words since their bytes, one by one, take twice as long.
struct Differences {
  static constexpr std::size_t kWords = 4, kWord = 8;
  /// Bytes at each end. A slice that is shorter than both is not compared.
  static constexpr std::size_t kEnd = kWords / 2 * kWord;

  /// Where in a slice of `size` bytes that word begins.
  static std::size_t place(std::size_t word, std::size_t size) {
    return word * kWord < kEnd ? word * kWord : size - 2 * kEnd + word * kWord;
  }

  std::uint8_t differing = 0;  ///< bit n: word n differs
  std::array<std::uint64_t, kWords> words{};
};

/// The slices that a node has taken in last, as they lie in its recording. What it gives out is mostly one of them with
/// another HOP and another CRC. Finding that out takes less time than writing 500 bytes into memory that is in no
/// cache. (ours)
class SlicesTakenIn {
 public:
  /// @param recorded its bytes must stay where they are until forget()
  void add(const wire::Slice& recorded) { slices_[added_++ % slices_.size()] = recorded; }
  void forget() { first_ = added_; }
  /// Looks for one that `given_out` is but for its ends, in the order of arrival, behind the one that was found last.
  /// @param differences out: of both
  /// @return where its bytes lie; null: there is none, or `given_out` is too short
  const std::uint8_t* find(const wire::Slice& given_out, Differences& differences);

 private:
  std::array<wire::Slice, 32> slices_{};
  std::size_t added_ = 0;
  std::size_t first_ = 0;  ///< that may be found
};

}  // namespace limb_ring::recorder
