#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "wire/packet.h"
#include "wire/slice.h"

/// What nodes tell each other on the second line, in slices of their own between packets. (ours)
///
///   | mark 8 | node 8 |      2 bytes
namespace limb_ring::wire {

enum class FoldMark : std::uint8_t {
  begin = 1,  ///< what follows is the ring's traffic, turned back at `node`, which is before a break
  last,       ///< it was the last of it: `node` sends on the first line again
  lost,       ///< there is no more of it: the second line is broken at `node`
  deaf,       ///< to the neighbour only: `node` hears nothing on the first line
  hears       ///< to the neighbour only: it does again
};

struct FoldWord {
  FoldMark mark;
  NodeId node;
};
constexpr std::size_t kFoldWordSize = 2;

inline void put(SliceWriter& line, FoldWord word) {
  const std::array<std::uint8_t, kFoldWordSize> bytes{static_cast<std::uint8_t>(word.mark), word.node};
  line.put(SliceKind::fold, {bytes.data(), bytes.size()});
}

/// @return nothing where the slice is none, or says what nobody knows
inline std::optional<FoldWord> fold_word(const Slice& slice) {
  if (slice.kind != SliceKind::fold || slice.bytes.size != kFoldWordSize) return std::nullopt;
  const std::uint8_t mark = slice.bytes[0];
  if (mark < static_cast<std::uint8_t>(FoldMark::begin) || mark > static_cast<std::uint8_t>(FoldMark::hears))
    return std::nullopt;
  return FoldWord{static_cast<FoldMark>(mark), slice.bytes[1]};
}

}  // namespace limb_ring::wire
