#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <limb_ring/RingStatus.h>

#include <string>
#include <vector>

namespace limb_ring::bridge {

/// The condition of the whole ring, in the words of `ringctl status`. (ours)
///   ERROR  the bridge has no connection to its daemon
///   WARN   not every node is up: an open chain, folded, or some are down; or a stop is latched
void tell_ring(const RingStatus& ring, diagnostic_updater::DiagnosticStatusWrapper& out);

/// The same for people, with the CPUs that are silent or have failed; empty where nothing is wrong.
std::string what_is_wrong(const std::vector<NodeStatus>& nodes);

}  // namespace limb_ring::bridge
