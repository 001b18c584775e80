#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "wire/packet.h"
#include "wire/slice.h"

/// What nodes tell each other on the second line, in slices of their own between packets. (ours, protocol.md
/// section 8.8)
///
///   | kind 8 | node 8 | check 8 |      3 bytes; check = 0xFF xor kind xor node
///
/// A word that noise has changed would have a node fold, or unfold, for nothing: it is none, and the next one,
/// a beacon period later, says it again.
namespace limb_ring::wire {

enum class FoldWordKind : std::uint8_t {
  begin = 1,  ///< what follows is the ring's traffic, turned back at `node`, which is before a break
  last,       ///< it was the last of it: `node` sends on the first line again
  lost,       ///< there is no more of it: the second line is broken at `node`
  deaf,       ///< to the neighbour only: `node` hears nothing on the first line
  hears       ///< to the neighbour only: it does again
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

/// @return nothing where the slice is none, is damaged, or says what nobody knows
inline std::optional<FoldWord> fold_word(const Slice& slice) {
  if (slice.kind != SliceKind::fold || slice.bytes.size != kFoldWordSize) return std::nullopt;
  const std::uint8_t kind = slice.bytes[0];
  if (slice.bytes[2] != fold_check(kind, NodeId{slice.bytes[1]})) return std::nullopt;
  if (kind < static_cast<std::uint8_t>(FoldWordKind::begin) || kind > static_cast<std::uint8_t>(FoldWordKind::hears))
    return std::nullopt;
  return FoldWord{static_cast<FoldWordKind>(kind), NodeId{slice.bytes[1]}};
}

}  // namespace limb_ring::wire
