#pragma once

#include <string>
#include <vector>

namespace limb_ring::ringctl {

/// What a shell may complete: names of the rings that run, where `wanted` is "RING" or "--ring"; of a ring's nodes
/// where it is "NODE", "TO" and the like. Nothing where it is none of these, or the ring is not there or not clear. No
/// daemon that is frozen is asked, so nobody waits at the prompt.
/// @param ring as typed on the command line; empty: the only one running
std::vector<std::string> names_to_complete(const std::string& wanted, const std::string& ring);

/// The name behind `--ring`, or in `--ring=NAME`, among words of a command line; empty where there is none.
std::string typed_ring(const std::vector<std::string>& words);

}  // namespace limb_ring::ringctl
