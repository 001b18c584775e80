#pragma once

#include <limb_ring/NodeStatus.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "config/ring_config.h"

namespace limb_ring::bridge {

/// A node of which nothing is known: state "down".
NodeStatus unheard_node(const config::NodeConfig& node);

/// Fills in a status row, as docs/reference/requests.md describes it. Members that are missing or
/// of another type leave the field as it is.
void merge_status_row(const nlohmann::json& row, NodeStatus& status);

/// Fills in what another node has heard in this node's beacons: an entry of that row's `heard`. If the
/// node's own row is missing, but it was heard no longer than `fresh` ago, its state is `up`.
void merge_beacon(const nlohmann::json& heard, std::chrono::milliseconds fresh, NodeStatus& status);

}  // namespace limb_ring::bridge
