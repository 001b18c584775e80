#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limb_ring::ringctl {

/// A status row of every node (down_row() of one that does not answer), and when they were asked.
struct StatusSample {
  std::vector<nlohmann::json> rows;
  double at_s = 0;
};

/// What happened between two samples, a row for each node, rates where both have it:
/// {"id", "name", "state", "to", "packets_per_second", "bytes_per_second", "load", "round_trip_us", "errors", "cpu"}.
/// Rates are those of the line out of the node; its bytes are counted where they come in.
std::vector<nlohmann::json> top_rows(const StatusSample& before, const StatusSample& now);

/// A heading and a line for each node, at most 80 columns wide and `lines` long.
std::string top_table(const std::string& ring, const std::vector<nlohmann::json>& rows, std::size_t lines);

}  // namespace limb_ring::ringctl
