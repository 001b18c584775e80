#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace limb_ring::live {

/// What a virtual ring says of its clock (docs/reference/requests.md), with "now_s" for "now_ns". Null where the ring
/// goes by the machine's clock, or its process does not answer.
nlohmann::json ring_clock(const std::string& ring);

/// Why nothing goes on where the virtual clock of the ring stands, and what lets it go on; empty where it goes.
std::string standing_clock(const std::string& ring);
/// `problem`, of something that has not happened in time, and standing_clock() where it stands.
std::string with_standing_clock(const std::string& problem, const std::string& ring);

}  // namespace limb_ring::live
