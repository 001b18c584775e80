#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace limb_ring::ringctl {

// The daemon that answers may be of another version, or no ringd at all: before its answer is read, it is looked at
// whether everything in it that is read is as docs/reference/requests.md has it.

/// What is wrong with a status row of that node, as "'cpu.state' is not a string"; empty: nothing.
std::string wrong_in_row(const nlohmann::json& row, std::uint8_t node);
/// The same of an answer to "config".
std::string wrong_in_config(const nlohmann::json& config);

/// "unexpected reply from its daemon: 'cpu.state' is not a string; ...", with what to do.
std::string sentence_of_shape(const std::string& wrong);

}  // namespace limb_ring::ringctl
