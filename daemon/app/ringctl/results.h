#pragma once

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "limb_ring/host_port.h"

namespace limb_ring::ringctl {

/// Makes `count` sends, a few of them outstanding at a time, and waits for their results, with
/// progress on standard error. Every send ends by itself within the configured time-outs; the
/// guard is above all of them.
/// @param send makes one and returns its token
/// @param interval from one to the next; 0: as fast as they end
/// @return as many results, or those there are when somebody asks for an end (Ctrl-C). @throw HostPortError
std::vector<Result> send_all(HostPort& port, unsigned count, const std::function<std::uint32_t()>& send,
                             std::chrono::nanoseconds interval = {});

/// Prints one result, or how many ended how, or all as JSON. @return kDone where all were delivered, else kNotDone
int report(const std::vector<Result>& results, bool json);

nlohmann::json to_json(const Result& result);
/// "delivered in 61.2 us", "refused: no pin wired (in 70.1 us)", "lost after 4 tries"
std::string to_text(const Result& result);

}  // namespace limb_ring::ringctl
