#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "ring/ring_clock.h"

namespace limb_ring::ringctl {

using live::ring_clock;
using live::standing_clock;

/// What ring_clock() says, behind a headline: "; virtual clock at 12.345 s, pace 1, 0.020 s late, 3.100 s lost"; empty
/// for null.
std::string clock_words(const nlohmann::json& clock);

/// To be called when what was asked for has not been answered in time. @throw NotKnown with standing_clock(), where it
/// stands: it may happen once it goes on
void require_clock_goes(const std::string& ring);

/// "1", "0.1", "max"
std::string pace_text(const nlohmann::json& pace);

}  // namespace limb_ring::ringctl
