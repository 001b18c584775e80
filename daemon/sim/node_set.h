#pragma once

#include <array>
#include <cstdint>

#include "wire/packet.h"

namespace limb_ring::sim {

/// A set of nodes, given out lowest first.
class NodeSet {
 public:
  void insert(wire::NodeId id) { words_[id / 64] |= std::uint64_t{1} << (id % 64); }
  bool empty() const { return (words_[0] | words_[1] | words_[2] | words_[3]) == 0; }
  /// @pre !empty()
  wire::NodeId pop() {
    std::size_t word = 0;
    while (words_[word] == 0) ++word;
    const auto bit = static_cast<std::size_t>(__builtin_ctzll(words_[word]));
    words_[word] &= words_[word] - 1;
    return static_cast<wire::NodeId>(word * 64 + bit);
  }

 private:
  std::array<std::uint64_t, 4> words_{};
};

}  // namespace limb_ring::sim
