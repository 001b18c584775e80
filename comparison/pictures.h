#pragma once

#include <string>
#include <vector>

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

// ---- The pictures, one a file. Each may take a few seconds to be measured. ----

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

// ---- What their scripts share ----

/// "N = 16, B = 512 bytes, R = 1000 Mbit/s, d = 0.512 us, seed 1".
std::string figures_of(const study::ComparisonOptions& options);
/// The same with other words for N and R.
std::string figures_of(const study::ComparisonOptions& options, const std::string& nodes, const std::string& rate);
/// "1000 Mbit/s"
std::string rate_of(const study::Medium& medium);
/// `set title` with these lines.
std::string title(const std::string& first, const std::string& second);
/// A time in us, to the picosecond.
std::string us(study::Duration duration);

/// A column of a picture's figures.
struct Column {
  std::string name;  ///< without commas and quotes
  std::vector<std::string> cells;
};

/// As CSV with a heading. @pre all columns have the same number of cells
std::string csv_of(const std::vector<Column>& columns);

/// Adds a point of a method's curve: to the last column where it is that method's, else to a new one.
void add_point(std::vector<Column>& columns, const std::string& method, const std::string& cell);

}  // namespace limb_ring::comparison
