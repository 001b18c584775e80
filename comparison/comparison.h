#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "comparison/network.h"

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

/// @throw std::runtime_error if a method does not deliver what it was given: the model is wrong
Figures measure(const Network& network, const Medium& medium, std::uint64_t seed);

/// Figures::at_once_opposite alone.
Spread measure_at_once(const Network& network, const Medium& medium, Destination destination, std::uint64_t seed);

/// Payload delivered in a second / R while random arrivals offer `load` times R.
double measure_efficiency(const Network& network, const Medium& medium, double load, std::uint64_t seed);

/// One method at one rate.
struct Subject {
  std::string method;      ///< "limb_ring", "ARCNET" ...
  bool own_rate = false;   ///< at the rate of the paper's Table I; else at that of the medium given
  std::uint64_t rate = 0;  ///< bit/s
};

/// A row of the comparison: the paper's Table I, measured.
struct MethodRow {
  Subject subject;
  Figures figures;
};

/// A point of throughput against load.
struct LoadPoint {
  Subject subject;
  double offered = 0;    ///< payload asked for in a second / R
  double delivered = 0;  ///< payload delivered in a second / R
};

/// A point of latency against the number of nodes, all sending one message to the node opposite at
/// the same instant.
struct NodesPoint {
  Subject subject;
  unsigned nodes = 0;
  Spread at_once;
};

/// What is compared: the medium, and the points of each curve.
struct ComparisonOptions {
  Medium medium;
  std::uint64_t seed = 1;
  std::vector<double> loads{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
  std::vector<unsigned> nodes{2, 4, 8, 16, 32, 64};
  std::function<void(const Subject&)> tell = [](const Subject&) {};  ///< called again and again
};

/// The subjects in the same order everywhere: all at the medium's rate, then all at their own; the
/// points of one subject follow each other, in the order of the options.
struct Comparison {
  std::vector<MethodRow> methods;
  std::vector<LoadPoint> against_load;
  std::vector<NodesPoint> against_nodes;
};

/// Whether a full load of messages fits into memory, also at the fastest of the methods' own rates: there are not too
/// many nodes, and the relay delay is not too long beside the time that the payload takes on the line.
bool comparable(const Medium& medium);

/// Our ring and the systems that the paper compares it with, each on its own virtual clock.
/// @pre comparable(options.medium)
/// @throw std::runtime_error if a model or the ring does not deliver what it was given
Comparison compare(const ComparisonOptions& options);

}  // namespace limb_ring::study
