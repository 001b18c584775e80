#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/node_row.h"

namespace limb_ring::ringctl {

/// What the rows of `status --json` say of lines that are broken, noisy, or made so on purpose: a line of text
/// each, empty where all is well.
std::string line_report(const std::vector<status::NodeRow>& rows);

/// How long a sync interrupt took from one node to the next that latched. (ours)
struct LineDelay {
  std::size_t from = 0, to = 0;  ///< indices in ring order
  std::optional<double> us;      ///< empty: the two have different clocks, and one way alone cannot be known
};

/// What the latches of one sync interrupt tell about the lines, in the order in which it travelled: from the source
/// around the ring back to it.
struct LineDelays {
  std::vector<LineDelay> lines;
  unsigned between_hosts = 0;   ///< how many of them lead from one clock to another
  double between_hosts_us = 0;  ///< of all these together: the round trip less what is known
  /// By so much at least the times are wrong; 0: not known. A node may latch after it has passed the interrupt on: a
  /// time that comes out below 0 tells by how much.
  double uncertain_us = 0;
};

/// Two latches on one host are by the same clock, so their difference is a one-way delay. Between hosts it also
/// contains the difference of the clocks; only the sum around the ring does not.
/// @param latches_ns as clock_offsets() takes them, but for the source when the interrupt left it
/// @param hosts of each node in ring order: nodes with the same one have one clock
LineDelays line_delays(const std::vector<std::optional<std::int64_t>>& latches_ns,
                       const std::vector<std::string>& hosts, std::size_t source, double round_trip_us);

}  // namespace limb_ring::ringctl
