#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/node_row.h"
#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

/// In ring order.
using Rows = std::vector<status::NodeRow>;

/// The row of a node that has no daemon: state "down", and nothing of what only that knows.
status::NodeRow down_row(const NodeName& node);
/// The rows of all nodes in ring order, with the supervisor's verdicts on the CPUs. For a node that has not answered:
/// "frozen" and its pid if its process on this host is stopped; "unanswered", its pid and the reason, if that lives, or
/// if that cannot be known; `elsewhere`, with state, CPU and clock latch from its beacons, if these are heard and it is
/// on another host or has never run on this one; else "down".
/// @param told in ring order
Rows complete_rows(const RingAccess& ring, const std::vector<ask::ToldRow>& told);
/// The same of all daemons on this host, asked now.
Rows status_rows(const RingAccess& ring, Deadline deadline = kNoDeadline);

/// @name What a row means, in the words that status, top and wait share
///@{
/// The name of the node with that id, or the id if it has no row.
std::string node_name(const Rows& rows, std::uint8_t id);
/// "left_hip -> left_knee", by their ids.
std::string line_name(const Rows& rows, std::uint8_t before, std::uint8_t behind);
/// "running", "booting" ...; "hung" if its process is stopped, or by the supervisor's verdict: the node's own network
/// controller says no more than "silent", and that only of a CPU that has promised to speak; "stopped" since a stop,
/// until `resume`.
std::string cpu_word(const status::NodeRow& row);
/// "round trips of the last 60 s": since when the percentiles of these rows are; empty if there are none.
std::string round_trips_since(const Rows& rows);
/// Packets, and datagrams of them, that were damaged, lost or thrown away at this node since its start:
/// ErrorCounter::of_packets, added up.
std::uint64_t errors_of(const status::NodeRow& row);
/// "ring humanoid16: 16 of 16 nodes up", and whether it is folded back, or an open chain and where it is broken.
std::string headline(const std::string& ring, const Rows& rows);
/// The nodes that have not answered, and why; empty if all have.
std::string unanswered_report(const Rows& rows);
/// The nodes that are stopped, and what ends it; empty if none is.
std::string stop_report(const Rows& rows);
/// All of these, with line_report() and supervision_text().
std::string whole_report(const Rows& rows);
///@}

/// @name What the ring's supervisor says in its own status row, told of all
/// Rows as of `status --json`; a supervisor that does not answer says nothing.
///@{
/// Adds `cpu.verdict` to the row of every CPU that is watched.
void add_verdicts(Rows& rows);

/// A line for each watched CPU that is in trouble or was; empty if none.
std::string supervision_text(const Rows& rows);
///@}

struct StatusStyle {
  std::size_t width = std::string::npos;  ///< columns there are; names are shortened to fit
  bool pids = false;                      ///< process numbers too
  bool colour = false;
};

/// Status rows, one line each, for people.
std::string status_table(const Rows& rows, const StatusStyle& style = {});

/// Red for a node that is not up, yellow for a CPU that should run and does not, else none (an empty text).
const char* status_colour(const std::string& state, const std::string& cpu);

/// Microseconds for people: a decimal only if it says something; "-" for none.
std::string us_cell(std::optional<double> us);

/// What the rows of `status --json` say of lines that are broken, noisy, or made so on purpose: a line of text
/// each, empty if all is well.
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
