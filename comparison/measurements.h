#pragma once

#include <optional>
#include <vector>

#include "study/model_ring.h"

namespace limb_ring::study {

/// How many values lie above `from` and not above `to`.
struct Bin {
  Duration from{0}, to{0};
  std::size_t count = 0;
};

/// Bins of one width without gaps, from the bin of the smallest value to that of the greatest; all limits are
/// multiples of the width. Empty if there are no values.
/// @param values above zero
/// @param width above zero
std::vector<Bin> histogram(const std::vector<Duration>& values, Duration width);

/// Round trips of DATPs of our ring under random load, from the start of sending until the tail is back:
/// what N (T + d) bounds. The wait in the sender's own queue is not in it.
/// @param load payload offered / R
/// @throw std::runtime_error if the ring does not close
Latencies data_round_trips(const Medium& medium, double load, std::uint64_t seed);

/// Round trips of INTPs of our ring, from the CPU's request until they are back, while every node always
/// has a DATP to send and one INTP under way or about to be asked for.
/// @param embed false: they are sent between DATPs only
/// @throw std::runtime_error as above, and if an INTP or DATP is not delivered
Latencies interrupt_round_trips(const Medium& medium, bool embed, std::uint64_t seed);

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

/// No other packet is on the ring. @throw std::runtime_error if the ring does not close, or it does not return
Timeline timeline_alone(const Medium& medium);

/// The worst case: every other node starts a packet of its own in the instant in which its header arrives.
/// (protocol.md section 7.2) @throw std::runtime_error as above
Timeline timeline_worst(const Medium& medium);

}  // namespace limb_ring::study
