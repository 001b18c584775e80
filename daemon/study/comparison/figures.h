#pragma once

#include <cstdint>
#include <optional>

#include "study/comparison/network.h"
#include "study/comparison/offered_load.h"

namespace limb_ring::study {

/// Of latencies, from the CPU's request to the last bit at the destination.
struct Spread {
  Duration worst{0};  ///< the longest seen
  Duration mean{0};
};

/// What is measured of one method on one medium. (ours)
struct Figures {
  Spread alone;                       ///< one message in an idle network, to the node opposite
  Spread at_once_opposite;            ///< every node one message at the same instant, to the node opposite
  Spread at_once_random;              ///< the same, to random destinations
  std::optional<Spread> random_load;  ///< random arrivals that offer kRandomLoad; none: more than it can carry
  Spread interrupt;                   ///< interrupt-like messages, while every node has always data to send
  Duration join{0};                   ///< Network::time_to_join
  double efficiency = 0;              ///< payload delivered in a second / R, every node always having data to send
};

/// Share of R offered in Figures::random_load: below the saturation of every method compared at
/// 512 bytes in 16 nodes.
constexpr double kRandomLoad = 0.3;

// Every method is given the same messages for the same seed. The instant at which all ask, or one
// alone, is drawn many times over some of its cycles, so that a method with a cycle or token meets its
// bad moments as well as its good ones.

/// How many messages measure() has at once, the longest of its lists.
std::uint64_t full_load(const Medium& medium);

/// @throw std::runtime_error where a method does not deliver what it was given: the model is wrong
Figures measure(const Network& network, const Medium& medium, std::uint64_t seed);

/// Figures::at_once_opposite alone.
Spread measure_at_once(const Network& network, const Medium& medium, Destination destination, std::uint64_t seed);

/// Payload delivered in a second / R while random arrivals offer `load` times R.
double measure_efficiency(const Network& network, const Medium& medium, double load, std::uint64_t seed);

}  // namespace limb_ring::study
