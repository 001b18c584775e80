#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "config/ring_config.h"
#include "node/faults.h"
#include "node/node_driver.h"

namespace limb_ring::runtime {

using Answer = std::function<void(const nlohmann::json&)>;

/// What requests about faults are for.
struct FaultTargets {
  const config::RingConfig& ring;
  const config::NodeConfig& node;
  const NodeDriver& driver;
  Faults& faults;
  std::function<void()> power_cycle;  ///< sends no answer: the process, or the node, ends
};

/// @name Requests about faults, as docs/reference/requests.md describes them
/// @throw RequestError, fault::ParseError: their text is the answer
///@{
void begin_fault(const FaultTargets& to, const nlohmann::json& request, const Answer& answer);
void list_faults(const FaultTargets& to, const nlohmann::json& request, const Answer& answer);
void remove_fault(const FaultTargets& to, const nlohmann::json& request, const Answer& answer);
void clear_faults(const FaultTargets& to, const nlohmann::json& request, const Answer& answer);
///@}

/// Requests about the clock of a virtual ring. @throw RequestError
namespace clock_requests {
void allow(ClockControl& clock, const nlohmann::json& request, const Answer& answer);
void pace(ClockControl& clock, const nlohmann::json& request, const Answer& answer);
void pause(ClockControl& clock, const nlohmann::json& request, const Answer& answer);
void run(ClockControl& clock, const nlohmann::json& request, const Answer& answer);
void step(ClockControl& clock, const nlohmann::json& request, const Answer& answer);
void went_on_without(ClockControl& clock, const nlohmann::json& request, const Answer& answer);
}  // namespace clock_requests

/// What a virtual clock says of itself, into the answer to `clock`.
void add_state(const ClockControl& clock, nlohmann::json& answer);

}  // namespace limb_ring::runtime
