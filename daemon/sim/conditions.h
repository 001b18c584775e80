#pragma once

#include <string>

#include "sim/stage.h"

namespace limb_ring::scenario {

/// Whether a condition holds at this moment.
bool holds(const Condition& condition, const StageView& view);

/// The same for what has to hold at every moment: a latency does also while nothing has been confirmed.
bool holds_so_far(const Condition& condition, const StageView& view);

/// What the ring shows at the moment, in words: "left_knee is joining, in a ring of 15".
std::string seen(const Condition& condition, const StageView& view);

}  // namespace limb_ring::scenario
