#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limb_ring::ringctl {

/// What the rows of `status --json` say of lines that are broken, noisy, or made so on purpose: a line of text
/// each, empty where all is well.
std::string line_report(const std::vector<nlohmann::json>& rows);

}  // namespace limb_ring::ringctl
