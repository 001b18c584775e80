#pragma once

#include <functional>
#include <string>
#include <vector>

#include "study/comparison/figures.h"

namespace limb_ring::study {

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
/// @throw std::runtime_error where a model or the ring does not deliver what it was given
Comparison compare(const ComparisonOptions& options);

}  // namespace limb_ring::study
