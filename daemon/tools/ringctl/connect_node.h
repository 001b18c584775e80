#pragma once

#include <chrono>
#include <string>

#include "ring/connect_node.h"

namespace limb_ring::ringctl {

using live::connect_node;
using live::Stay;

/// As connect_node(), with an end. @throw HostPortTimeout, worded by no_answer_within(), where it takes longer
HostPort connect_within(std::chrono::milliseconds time, const std::string& ring, const std::string& node, Stay stay);

/// "its daemon did not answer within 500 ms"
std::string no_answer_within(std::chrono::milliseconds time);

/// The error for a daemon that has gone while it was asked: names the node, and says why.
HostPortError gone(const HostPort& port, const std::string& reason);

}  // namespace limb_ring::ringctl
