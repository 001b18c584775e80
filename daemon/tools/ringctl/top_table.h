#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

/// A status row of every node (as complete_rows() has them), and when they were asked.
struct StatusSample {
  Rows rows;
  double at_s = 0;                 ///< of the machine's clock; a row with `uptime_s` has a better one
  nlohmann::json clock = nullptr;  ///< ring_clock()
};

/// What happened between two samples, a row for each node, rates where both have it:
/// {"id", "name", "state", "to", "packets_per_second", "bytes_per_second", "load", "round_trip_us", "errors", "cpu",
/// "changed"}. Rates are those of the line out of the node, its bytes are counted where they come in; the load is
/// their share of the line's rate, null where the line has none. "changed" names those of state, cpu and errors that
/// are not as they were.
std::vector<nlohmann::json> top_rows(const StatusSample& before, const StatusSample& now);

struct TopStyle {
  std::size_t lines = std::string::npos;  ///< lines there are
  std::size_t width = 80;                 ///< columns there are, 80 at least; what is over goes to the names
  bool colour = false;                    ///< ... and what has changed is marked
};

/// A heading and a line for each node.
/// @param report what there is to say below, lines of text; shown where there is room
std::string top_table(const std::string& heading, const std::vector<nlohmann::json>& rows, const TopStyle& style = {},
                      const std::string& report = {});

}  // namespace limb_ring::ringctl
