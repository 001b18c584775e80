#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {

/// Says in words what is still missing in the status rows; empty if the wait is over.
using Lack = std::function<std::string(const Rows& rows)>;

/// What keeps the ring from being whole. It is whole when every node is up in a ring of all nodes, not folded back; its
/// second line, if it has one, is connected; and every CPU that its ringd starts runs.
std::string lack_of_whole(const Rows& rows);

/// A node's state, or its CPU's, in the words of `ringctl status`.
/// @return what they are instead; empty where one of them is `state`. @throw UsageError where there is no such node
std::string lack_of_state(const Rows& rows, const std::string& node, const std::string& state);

/// All words that lack_of_state() knows.
std::vector<std::string> state_words();

/// Asks until nothing is lacking; a ring that does not run yet may come.
/// @param ring its name; empty: the only one running
/// @return what was lacking at the end: after `timeout`, or when somebody asked for it (Ctrl-C); empty: nothing
/// @throw what `lack` throws
std::string wait_for(const std::string& ring, std::chrono::milliseconds timeout, const Lack& lack);

}  // namespace limb_ring::ringctl
