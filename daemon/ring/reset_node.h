#pragma once

#include <optional>

#include "ring/status_rows.h"

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

/// How many times the target's CPU has booted, as told by its own status row or by that of a node that has heard its
/// beacon in the last second.
std::optional<std::uint32_t> boots_in(const nlohmann::json& row, std::uint8_t target);

/// Whether it is known, in the same way, that the target has no CPU that could be reset.
bool has_no_cpu(const Rows& rows, std::uint8_t target);

/// The node that should send. In an open chain, if the sender is free: the node behind the break, which reaches all
/// others.
std::uint8_t best_sender(const Rows& rows, const ResetQuery& query);

/// Corrects an answer in which the sending daemon does not know the effect: if other rows show that the CPU has booted
/// again, sets `success`, `effect`, `boots`, `message` and `seen_by`. @param before rows from before the reset
nlohmann::json judged(nlohmann::json answer, const ResetQuery& query, const Rows& before, const Rows& now);

/// Resets, and waits until the effect is known: at most for `timeout` and a little more.
/// @return the daemon's answer to the request `reset`; effect "seen", "none" or "unknown"
/// @throw HostPortError where the daemon does not answer, or says that it cannot be done; live::NotDone where the node
/// has no CPU
nlohmann::json reset_node(ResetQuery query);

}  // namespace limb_ring::ask
