#pragma once

#include <string>
#include <vector>

#include "study/analysis/plan.h"
#include "study/analysis/response.h"

namespace limb_ring::study {

/// What a bound consists of: "own + 2 of higher or same priority + 1 ahead (4.192 us), laps of up to 75.264 us".
std::string in_words(const Response& response, Duration ahead, Duration longest_lap);

/// What keeps the ring from carrying its streams, a sentence each: a node or a line with too much to do,
/// a buffer that is too small, a time-out that is too short, a stream that may wait too long.
std::vector<std::string> limits_of(const config::RingConfig& ring, const std::vector<Stream>& streams,
                                   const Plan& plan);

}  // namespace limb_ring::study
