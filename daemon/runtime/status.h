#pragma once

#include <nlohmann/json.hpp>

namespace limb_ring::runtime {

class Node;

/// A node's row of `ringctl status --json`, as daemon/host/requests.md describes it.
nlohmann::json status_row(Node& node);

}  // namespace limb_ring::runtime
