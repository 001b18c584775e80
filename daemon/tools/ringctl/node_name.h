#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {

/// A node as a running ring tells of it.
struct NodeName {
  std::uint8_t id = 0;
  std::string name;
  std::string host = {};  ///< empty where the ring's file gives no hosts
};

/// "12 (left_knee)"
std::string label(const NodeName& node);

/// The error for a node that the ring does not have: lists those it has, and guesses which was meant.
UsageError unknown_node(const std::string& word, const std::string& ring, const std::vector<NodeName>& nodes);

}  // namespace limb_ring::ringctl
