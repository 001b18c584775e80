#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "wire/packet.h"

namespace limb_ring::core {

/// Sequence numbers of one kind of packet: per DID, from 0 after a hello, broadcast being a DID of
/// its own. Three bits wrap; a receiver that has decided none of the last 7 could mistake a new
/// packet for an old one, so after 6 sends in a row without its verdict new numbers are due. (ours, protocol.md
/// section 4.7)
class SequenceNumbers {
 public:
  /// Code of a first try to `destination`.
  wire::Code next(bool interrupt, wire::NodeId destination) {
    const wire::Sequence sequence{static_cast<std::uint8_t>((*counts_)[destination].next++ & 7)};
    return {interrupt, 0, sequence, incarnation_};
  }
  void decided(wire::NodeId destination) { (*counts_)[destination].undecided = 0; }
  void undecided(wire::NodeId destination) {
    if (++(*counts_)[destination].undecided >= kMostUndecided) exhausted_ = true;
  }
  /// New numbers (a new hello) are due.
  bool exhausted() const { return exhausted_; }
  /// The numbers of a new incarnation.
  void restart(std::uint64_t boot) {
    *this = {};
    incarnation_ = wire::incarnation_of(boot);
  }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("counts", *counts_)("exhausted", exhausted_)("incarnation", incarnation_);
  }

 private:
  static constexpr int kMostUndecided = 6;
  struct Count {
    std::uint8_t next = 0;
    std::uint8_t undecided = 0;
    template <class Archive>
    void archive(Archive& a) {
      a("next", next)("undecided", undecided);
    }
  };
  using Counts = std::array<Count, 256>;
  std::unique_ptr<Counts> counts_ = std::make_unique<Counts>();  ///< on the heap, as Flight's bytes
  bool exhausted_ = false;
  wire::Incarnation incarnation_{};
};

}  // namespace limb_ring::core
