#pragma once

#include <optional>

#include "ask/status_rows.h"

namespace limb_ring::ask {

/// A reset of one node's CPU: one daemon is asked for it, all are polled for its effect.
struct ResetQuery {
  std::string ring;
  std::vector<Node> nodes;  ///< all of the ring, in ring order
  std::uint8_t target = 0;
  std::uint8_t from = 0;      ///< the node that sends
  bool from_is_free = false;  ///< in an open chain another one may send, that reaches the target
  std::chrono::milliseconds timeout{3000};
};

/// How many times the target's CPU has booted, as far as a row tells: its own, or one that has lately heard it.
std::optional<std::uint32_t> boots_in(const nlohmann::json& row, std::uint8_t target);

/// Who sends so that the INTP arrives in an open chain: the node behind the break reaches all others.
std::uint8_t best_sender(const Rows& rows, const ResetQuery& query);

/// Where the daemon that sent cannot know what has become of it, by what the others see: the answer with `success`,
/// `effect`, `message` and `seen_by` as they are then. @param before rows from before the reset
nlohmann::json judged(nlohmann::json answer, const ResetQuery& query, const Rows& before, const Rows& now);

/// Resets, and waits until it is known what has become of it, for `timeout` and a little more.
/// @return the daemon's answer to the request `reset`; effect "seen", "none" or "unknown"
/// @throw HostPortError where the daemon does not answer, or says that it cannot be done
nlohmann::json reset_node(ResetQuery query);

}  // namespace limb_ring::ask
