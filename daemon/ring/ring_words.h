#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace limb_ring::ask {

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
