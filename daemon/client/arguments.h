#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "limb_ring/reason.h"

namespace limb_ring::client {

/// Why a call is rejected before anything is sent.
struct Problem {
  Reason why = Reason::none;
  std::string text;  ///< with the value that is wrong
};

/// What is wrong with the arguments of a call; nothing if they are right: the value, and the words of
/// limb_ring/reason.h. The daemon asks here for every call of a client; what the daemon itself sends, the core checks.
std::optional<Problem> send_problem(std::size_t size, std::uint8_t priority, std::uint8_t channel);
std::optional<Problem> interrupt_problem(std::uint8_t factor);
std::optional<Problem> pull_problem(std::uint8_t input);

/// Lists and objects within each other that JSON on a host port may have. (ours: what reads or writes JSON calls
/// itself for each level, so that 64 kB of brackets would need more stack than a process has)
constexpr std::size_t kMostJsonLevels = 32;
/// Counts only the brackets: a text that passes may still be invalid JSON.
std::optional<std::string> json_problem(std::string_view json);

/// All kinds of events that a daemon tells its observers, as an observe filter names them. See "Observing" in
/// docs/reference/requests.md.
const std::vector<std::string>& event_kinds();

}  // namespace limb_ring::client
