#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace limb_ring::ringctl {

/// What a virtual ring says of its clock (daemon/host/requests.md), with "now_s" for "now_ns". Null where the ring goes
/// by the machine's clock, or its process does not answer.
nlohmann::json ring_clock(const std::string& ring);

/// The same behind a headline: "; virtual clock at 12.345 s, pace 1, 0.020 s late, 3.100 s lost"; empty for null.
std::string clock_words(const nlohmann::json& clock);

/// Why nothing goes on where the virtual clock of the ring stands, and what lets it go on; empty where it goes.
std::string standing_clock(const std::string& ring);
/// To be called when what was asked for has not been answered in time. @throw NotKnown with standing_clock(), where it
/// stands: it may happen once it goes on
void require_clock_goes(const std::string& ring);

/// "1", "0.1", "max"
std::string pace_text(const nlohmann::json& pace);

}  // namespace limb_ring::ringctl
