#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace limb_ring::ask {

/// A counter of a node's daemon that grows only where something goes wrong. (ours)
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

}  // namespace limb_ring::ask
