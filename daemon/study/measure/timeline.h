#pragma once

#include <optional>
#include <vector>

#include "study/analysis/medium.h"

namespace limb_ring::study {

/// A packet at one node. All times count from the start of sending of packet 0, and are those of the
/// Packet Manager: what arrives has the relay delay behind it, what leaves has it ahead.
struct Passing {
  NodeId source{0};
  unsigned hop = 0;  ///< how far it has come: 0 at its source, N when it is back
  struct Span {
    Duration header{0};  ///< its first bit
    Duration tail{0};    ///< its last bit has passed
  };
  std::optional<Span> arrives;  ///< none at its source
  std::optional<Span> leaves;   ///< none when it is back

  NodeId node(const Medium& medium) const { return static_cast<NodeId>((source + hop) % medium.nodes); }
};

/// One packet of node 0 on its way round, and what went in front of it.
struct Timeline {
  std::vector<Passing> ours;      ///< by hop, 0 to N
  std::vector<Passing> in_front;  ///< what left a node before ours did, by source and hop
};

/// No other packet is on the ring. @throw std::runtime_error where the ring does not close, or it does not return
Timeline timeline_alone(const Medium& medium);

/// The worst case: every other node starts a packet of its own in the instant in which its header arrives.
/// (protocol.md section 7.2) @throw std::runtime_error as above
Timeline timeline_worst(const Medium& medium);

}  // namespace limb_ring::study
