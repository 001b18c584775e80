#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ring/live_faults.h"

namespace limb_ring::ringctl {

/// `ringctl fault list`: one line a fault, for people.
std::string fault_table(const std::vector<live::LiveFault>& faults);
/// ... and for programs; null for what the fault does not have.
nlohmann::json to_json(const live::LiveFault& fault);

}  // namespace limb_ring::ringctl
