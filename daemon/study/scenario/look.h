#pragma once

#include <string>

#include "study/scenario/robot.h"

namespace limb_ring::study::scenario {

/// Whether a condition holds at this moment.
bool holds(const Condition& condition, const Robot& robot);

/// What there is to see of it instead, in words: "left_knee is joining, in a ring of 15".
std::string seen(const Condition& condition, const Robot& robot);

}  // namespace limb_ring::study::scenario
