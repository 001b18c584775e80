#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/ringctl/ring_access.h"

namespace limb_ring::ringctl {

/// The row of a node whose daemon does not answer: state "down", and null for what only it knows.
nlohmann::json down_row(const NodeName& node);

/// Rows of `status --json`, one line each, for people.
std::string status_table(const std::vector<nlohmann::json>& rows);

}  // namespace limb_ring::ringctl
