#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limb_ring::ringctl {

/// @name What the ring's supervisor says in its own status row, told of all
/// Rows as of `status --json`; a supervisor that does not answer says nothing.
///@{
/// Adds `cpu.verdict` to the row of every CPU that is watched.
void add_verdicts(std::vector<nlohmann::json>& rows);

/// A line for each watched CPU that is in trouble or was; empty where none.
std::string supervision_text(const std::vector<nlohmann::json>& rows);
///@}

}  // namespace limb_ring::ringctl
