#pragma once

#include <string>

namespace limb_ring::ringctl {

/// Of the recordings in `folder`, as `ringctl record save` has just put them there: those of lives that have ended, a
/// line each: "  3.record.former: node3, begun 2026-11-23 06:15:08". Some may be of a ring of the same name that ran
/// before and was not taken down. Empty where there are none.
std::string ended_lives(const std::string& ring_folder, const std::string& folder);

}  // namespace limb_ring::ringctl
