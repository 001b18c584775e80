#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

/// How long a daemon may take for an answer that needs no waiting.
constexpr std::chrono::milliseconds kAnswerTime{2000};
/// How long it may take to answer a request that sends an interrupt: the answer comes when the interrupt has ended.
constexpr std::chrono::milliseconds kInterruptTime{10'000};

/// Asks a daemon, with progress on standard error where it takes long.
/// @throw NotDone with what the daemon says is wrong; HostPortError where it does not answer
nlohmann::json ask(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout);
/// The same, with `tick` called now and then while it waits; it may throw.
nlohmann::json ask(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout,
                   const std::function<void()>& tick);

/// Asks all of these nodes at the same time. No answer takes longer than kAnswerTime.
std::vector<ask::Answer> ask_all(const std::string& ring, const std::vector<NodeName>& nodes,
                                 const nlohmann::json& request, Deadline deadline = kNoDeadline);

/// The same of their status rows.
std::vector<ask::ToldRow> ask_for_rows(const std::string& ring, const std::vector<NodeName>& nodes,
                                       Deadline deadline = kNoDeadline);

}  // namespace limb_ring::ringctl
