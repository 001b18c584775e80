#pragma once

#include <random>
#include <vector>

#include "study/comparison/network.h"

namespace limb_ring::study {

// What the methods are given to carry. All times and nodes are drawn from the generator with integer
// arithmetic of our own: the same seed gives the same list on every machine. (ours)

using Random = std::mt19937_64;

/// Uniform in [0, below). @pre below > 0
std::uint64_t draw(Random& random, std::uint64_t below);

/// To whom a node sends.
enum class Destination {
  opposite,  ///< half the ring away, rounded down
  random     ///< any other node, each equally likely
};

/// One message of one node, priority 0, B bytes.
Message message(const Medium& medium, Time asked, NodeId source, Destination destination, Random& random);

/// Every node asks for `each` messages at the same instant.
std::vector<Message> all_at_once(const Medium& medium, Time asked, unsigned each, Destination destination,
                                 Random& random);

/// Random arrivals within [from, from + span): as many as offer `load` times R of payload, each at a
/// uniform moment and node, to a random destination: Poisson arrivals, given their number.
std::vector<Message> random_load(const Medium& medium, double load, Time from, Duration span, Random& random);

/// `count` interrupt-like messages from random nodes to random others, added to `load` in order: one in
/// every `gap`, at a random moment of its first half, so that they seldom meet each other.
std::vector<Message> with_interrupts(std::vector<Message> load, const Medium& medium, unsigned count, Duration gap,
                                     Random& random);

}  // namespace limb_ring::study
