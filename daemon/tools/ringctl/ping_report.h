#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/ringctl/ping_run.h"
#include "tools/ringctl/ping_totals.h"

namespace limb_ring::ringctl {

/// "512 bytes to left_knee (10): seq=1 time=61.2 us", or how else it ended.
std::string ping_line(const PingOrder& order, std::uint64_t sequence, const Result& result);
/// The statistics at the end, for people ...
std::string ping_text(const PingOrder& order, const PingTotals& totals);
/// ... and for programs.
nlohmann::json ping_json(const PingOrder& order, const PingTotals& totals);

}  // namespace limb_ring::ringctl
