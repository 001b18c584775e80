#pragma once

#include <string>

#include "study/scenario/stage.h"

namespace limb_ring::study::scenario {

/// Whether a condition holds at this moment.
bool holds(const Condition& condition, const Sight& robot);

/// What there is to see of it instead, in words: "left_knee is joining, in a ring of 15".
std::string seen(const Condition& condition, const Sight& robot);

}  // namespace limb_ring::study::scenario
