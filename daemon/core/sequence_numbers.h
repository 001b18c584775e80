#pragma once

#include <array>
#include <cstdint>

#include "wire/packet.h"

namespace limb_ring::core {

/// Sequence numbers of one kind of packet: per DID, from 0 after a hello, broadcast being a DID of
/// its own. Three bits wrap; a receiver that has decided none of the last 7 could mistake a new
/// packet for an old one, so after 6 sends in a row without its verdict new numbers are due. (ours)
class SequenceNumbers {
 public:
  std::uint8_t next(wire::NodeId destination) {
    return counts_[destination].next++ & 7;
  }
  void decided(wire::NodeId destination) { counts_[destination].undecided = 0; }
  void undecided(wire::NodeId destination) {
    if (++counts_[destination].undecided >= kMostUndecided) exhausted_ = true;
  }
  /// New numbers (a new hello) are due.
  bool exhausted() const { return exhausted_; }
  void restart() { *this = {}; }

 private:
  static constexpr int kMostUndecided = 6;
  struct Count {
    std::uint8_t next = 0;
    std::uint8_t undecided = 0;
  };
  std::array<Count, 256> counts_{};
  bool exhausted_ = false;
};

}  // namespace limb_ring::core
