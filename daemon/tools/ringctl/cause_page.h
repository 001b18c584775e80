#pragma once

#include <chrono>
#include <vector>

#include "sim/scenario_cause.h"
#include "tools/common/picture_page.h"

namespace limb_ring::ringctl {

/// The events that a cause names, as marks on a picture of the nodes' states.
/// @param from the picture's time 0, in the story's time
std::vector<app::TimeMark> marks_of(const scenario::Cause& cause, const scenario::Story& story,
                                    std::chrono::nanoseconds from = std::chrono::nanoseconds(0));

}  // namespace limb_ring::ringctl
