#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {

/// How long a daemon may take for an answer that needs no waiting.
constexpr std::chrono::milliseconds kAnswerTime{2000};
/// How many are asked at the same time: all of a ring, as one that is silent takes all of that.
constexpr std::size_t kAskers = 256;
/// How long it may take to answer a request that sends an interrupt: the answer comes when the interrupt has ended.
constexpr std::chrono::milliseconds kInterruptTime{10'000};

/// What a node has answered, or why it has not.
struct Answer {
  std::optional<nlohmann::json> said;
  std::string why_not;  ///< empty where it has answered, or was not asked: it is frozen
};

/// Asks a daemon, with progress on standard error where it takes long.
/// @throw NotDone with what the daemon says is wrong; HostPortError where it does not answer
nlohmann::json ask(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout);
/// The same, with `tick` called now and then while it waits; it may throw.
nlohmann::json ask(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout,
                   const std::function<void()>& tick);

/// Asks all of these nodes at the same time.
std::vector<Answer> ask_all(const std::string& ring, const std::vector<NodeName>& nodes, const nlohmann::json& request,
                            Deadline deadline = kNoDeadline);

// The daemon that answers may be of another version, or no ringd at all: before its answer is read, it is looked at
// whether everything in it that is read is as docs/reference/requests.md has it.

/// What is wrong with a status row of that node, as "'cpu.state' is not a string"; empty: nothing.
std::string wrong_in_row(const nlohmann::json& row, std::uint8_t node);
/// The same of an answer to "config".
std::string wrong_in_config(const nlohmann::json& config);

/// "unexpected reply from its daemon: 'cpu.state' is not a string; ...", with what to do.
std::string sentence_of_shape(const std::string& wrong);

}  // namespace limb_ring::ringctl
