#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "node/clock_control.h"
#include "node/fault_requests.h"

namespace limb_ring::runtime {

/// `allow`, `pace`, `pause`, `run`, `step`, `went_on_without`: answers one of these. @return false where it is none of
/// them
/// @param clock null on a live ring @throw RequestError
bool answer_clock_request(ClockControl* clock, const std::string& what, const nlohmann::json& request,
                          const Answer& answer);

/// What a virtual clock says of itself, into the answer to `clock`.
void add_state(const ClockControl& clock, nlohmann::json& answer);

}  // namespace limb_ring::runtime
