#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <vector>

#include "study/comparison/network.h"

namespace limb_ring::study {

/// What the CPUs have asked for and a method has not taken yet: per node, interrupt-like messages
/// before data, then by priority, then in the order asked. (ours; every method is given the same)
class SendQueues {
 public:
  enum class Kind { all, data, interrupts };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// @param messages must outlive this
  SendQueues(const Medium& medium, const std::vector<Message>& messages, Kind kind = Kind::all);

  /// Index of the message that `node` would send at `now`, or kNone. @pre `now` never runs
  /// backwards for one node
  std::size_t head(NodeId node, Time now);
  /// Bytes of that message which were not taken yet.
  unsigned remaining(std::size_t message) const { return remaining_[message]; }
  /// Takes at most so many bytes of a head. @return true where nothing of it is left
  bool take(std::size_t message, unsigned most);
  /// When the next message is asked for that no head() has seen yet; core::kNever: none.
  Time next_asked() const;

 private:
  struct Node {
    std::deque<std::size_t> to_come;
    std::array<std::deque<std::size_t>, kMessageClasses> asked;
  };

  const std::vector<Message>& messages_;
  std::vector<Node> nodes_;
  std::vector<unsigned> remaining_;
};

}  // namespace limb_ring::study
