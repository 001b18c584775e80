#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "wire/packet.h"
#include "wire/slice.h"

/// What nodes of a ring that folds back tell each other, in slices of their own between packets. (ours, protocol.md
/// section 8.8)
///
///   | kind 8 | node 8 | check 8 |      3 bytes; check = 0xFF xor kind xor node
///
/// A word that noise has changed could make a node fold, or unfold, for nothing. So one with a wrong check is
/// discarded; the sender repeats it a beacon period later.
namespace limb_ring::wire {

enum class FoldWordKind : std::uint8_t {
  begin = 1,  ///< what follows is the ring's traffic, turned back at `node`, which is before a break
  last,       ///< the end of that traffic: `node` sends on the first line again
  lost,       ///< no more of that traffic comes: the second line is broken at `node`
  deaf,       ///< to the neighbour only: `node` hears nothing on the first line
  hears       ///< to the neighbour only: `node` hears the first line again
};

struct FoldWord {
  FoldWordKind kind;
  NodeId node;
};

constexpr std::uint8_t fold_check(std::uint8_t kind, NodeId node) { return static_cast<std::uint8_t>(~(kind ^ node)); }

inline void put(SliceWriter& line, FoldWord word) {
  const auto kind = static_cast<std::uint8_t>(word.kind);
  const std::array<std::uint8_t, kFoldWordSize> bytes{kind, word.node, fold_check(kind, word.node)};
  line.put(SliceKind::fold, {bytes.data(), bytes.size()});
}

/// @return nothing if the slice is no fold word, is damaged, or has an unknown kind
inline std::optional<FoldWord> fold_word(const Slice& slice) {
  if (slice.kind != SliceKind::fold || slice.bytes.size != kFoldWordSize) return std::nullopt;
  const std::uint8_t kind = slice.bytes[0];
  if (slice.bytes[2] != fold_check(kind, NodeId{slice.bytes[1]})) return std::nullopt;
  if (kind < static_cast<std::uint8_t>(FoldWordKind::begin) || kind > static_cast<std::uint8_t>(FoldWordKind::hears))
    return std::nullopt;
  return FoldWord{static_cast<FoldWordKind>(kind), NodeId{slice.bytes[1]}};
}

}  // namespace limb_ring::wire
