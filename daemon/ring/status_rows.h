#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/node_row.h"
#include "ring/ring_client.h"

namespace limb_ring::ask {

/// How long a daemon may take to answer when rows are polled.
constexpr std::chrono::milliseconds kRowTimeout{500};

/// Status rows, by node id.
using Rows = std::map<std::uint8_t, status::NodeRow>;

/// The status rows of those daemons on this host that answer in time.
Rows status_rows(const std::string& ring, const std::vector<Node>& nodes, std::chrono::milliseconds timeout);

/// The same of all daemons on this host.
Rows status_rows_here(const std::string& ring, std::chrono::milliseconds timeout);

/// The beacon of a node that the daemon of this row has heard within the last second; null if it has heard none.
const status::Heard* lately_heard_in(const status::NodeRow& row, std::uint8_t node);
/// The newest of those that the daemons of this host have lately heard; null if none has.
const status::Heard* lately_heard(const Rows& rows, std::uint8_t node);

/// A node with a daemon on this host whose packets arrive at `target`, as its beacons do: in an open chain one before
/// it, round a fold one of its part. Nothing if the target's daemon does not answer here, or hears no such node.
std::optional<std::uint8_t> who_reaches(const Rows& rows, std::uint8_t target);

/// The name of a node, or its id where it is none of these.
std::string name_of(const std::vector<Node>& nodes, std::uint8_t id);

/// A counter of a node's daemon that grows only if something goes wrong. (ours)
struct ErrorCounter {
  /// What is to be looked at: the line into the node, the line out of it, or the node itself.
  enum class Of : std::uint8_t { input, output, node } of;
  std::string name;  ///< as in the node's status (protocol.md section 10)
  /// One count is a packet, a try, or a datagram of packets, that was damaged, lost or thrown away at this node:
  /// `ringctl status --watch` adds these up. The others count what a line or a link did, or what the receiving end was
  /// not ready for.
  bool of_packets;
};

/// All that /diagnostics warns of as they grow, and `ringctl status --watch` adds up.
const std::vector<ErrorCounter>& error_counters();

/// What is said of a whole ring is made of this, of each of its nodes.
struct NodeInRing {
  std::string state;          ///< as in its status row
  std::size_t ring_size = 0;  ///< as it has learned it; 0: not known
};

/// "16 of 16 nodes work, open chain: line waist -> left_hip broken". (ours)
/// @param broken_line its two nodes, "waist -> left_hip"; empty: nobody knows it
std::string ring_in_words(const std::vector<NodeInRing>& nodes, const std::string& broken_line);

/// How to reach the CPU of the first node of an open chain, which nothing reaches over the ring: "mend the line, or let
/// its daemon restart its CPU: 'ringctl fault reset left_hip'"
std::string way_to_first_of_chain(const std::string& node);

}  // namespace limb_ring::ask
