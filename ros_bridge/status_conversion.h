#pragma once

#include <limb_ring/NodeStatus.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "config/node_row.h"
#include "config/ring_config.h"
#include "limb_ring/host_port.h"

namespace limb_ring::bridge {

/// A node about which nothing is known: state "down".
NodeStatus unheard_node(const config::NodeConfig& node);

/// Fills in the node's own row.
void merge_status_row(const status::NodeRow& row, NodeStatus& status);

/// Fills in what another node has heard in this node's beacons. If the node's own row is missing, but its last beacon
/// is at most `fresh` old, its state is `up`.
void merge_beacon(const status::Heard& heard, std::chrono::milliseconds fresh, NodeStatus& status);

/// A member of a daemon's answer, if it is a whole number.
inline std::int64_t number_of(const nlohmann::json& said, const char* member, std::int64_t otherwise) {
  const auto found = said.find(member);
  return found != said.end() && found->is_number_integer() ? found->get<std::int64_t>() : otherwise;
}

/// An outcome as one word, for counters and messages: "no_such_node".
inline std::string outcome_word(std::string outcome) {
  std::replace(outcome.begin(), outcome.end(), ' ', '_');
  return outcome;
}
inline std::string outcome_word(Outcome outcome) { return outcome_word(to_string(outcome)); }

}  // namespace limb_ring::bridge
