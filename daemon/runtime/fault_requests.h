#pragma once

#include "runtime/requests.h"

namespace limb_ring::runtime {

/// @name Requests about faults, as daemon/host/requests.md describes them
/// @throw RequestError, fault::ParseError: their text is the answer
///@{
void begin_fault(Node& node, const nlohmann::json& request, const Requests::Answer& answer);
void list_faults(Node& node, const nlohmann::json& request, const Requests::Answer& answer);
void remove_fault(Node& node, const nlohmann::json& request, const Requests::Answer& answer);
void clear_faults(Node& node, const nlohmann::json& request, const Requests::Answer& answer);
///@}

}  // namespace limb_ring::runtime
