#pragma once

#include <string>

#include "comparison/comparison.h"

namespace limb_ring::comparison {

/// One picture: figures and the gnuplot commands that draw them.
struct Picture {
  std::string name;    ///< of its files, without extension: letters and '_'
  std::string csv;     ///< with a heading; times in us
  std::string script;  ///< from the title to the plot command; reads <name>.csv in its own folder
};

/// What the pictures are made of.
struct PlotInput {
  const study::Comparison& comparison;
  const study::ComparisonOptions& options;
};

// The pictures. Each may take a few seconds to be measured.

/// Worst latency of a simultaneous start against the number of nodes, all methods at the medium's rate.
Picture plot_latency_nodes(const PlotInput& input);
/// The same, each method at its rate in the paper's Table I.
Picture plot_latency_nodes_own_rates(const PlotInput& input);
/// Payload delivered against payload offered, all methods at the medium's rate.
Picture plot_efficiency(const PlotInput& input);
/// Round trips of our ring under random load just below its saturation.
Picture plot_round_trips(const PlotInput& input);
/// Round trips of INTPs beside large DATPs, with and without embedding.
Picture plot_embedding(const PlotInput& input);
/// One packet hop by hop, alone and in the worst case.
Picture plot_timeline_alone(const PlotInput& input);
Picture plot_timeline_worst(const PlotInput& input);

}  // namespace limb_ring::comparison
