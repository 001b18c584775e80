#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>

#include "limb_ring/host_port.h"
#include "ring/known_stops.h"
#include "ring/ring_client.h"
#include "wire/slice.h"

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
std::optional<std::uint32_t> boots_in(const status::NodeRow& row, std::uint8_t target);

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
/// @throw HostPortError if the daemon does not answer, or says that it cannot be done; live::NotDone if the node
/// has no CPU
nlohmann::json reset_node(ResetQuery query);

/// It was delivered, or may have been: in an open chain nothing returns, but what lies behind the break is known.
inline bool may_have_arrived(const Result& result) {
  if (result.outcome == Outcome::unconfirmed) return result.why != Reason::out_of_reach;
  return result.outcome == Outcome::delivered;
}

/// Sends a stop from the node with this id, and waits for its result, at most so long.
/// @return it was delivered. If it throws, nothing is known of that node.
using SendStop = std::function<bool(std::uint8_t from, std::chrono::milliseconds timeout)>;
/// Who should send the stop next, if it was not sent by these.
using NextSender =
    std::function<std::optional<std::uint8_t>(const SentStop& stop, const std::set<std::uint8_t>& senders)>;

/// Of nodes whose daemon is on this host, as far as they say now what was not reached.
std::optional<std::uint8_t> next_sender(const SentStop& stop, const std::set<std::uint8_t>& senders);

/// Has other nodes send a stop that one has sent, one after the other, until all that can be reached were reached: in
/// an open chain, or a ring that has folded into parts, one node does not reach all.
/// @param stop its `delivered` is that of all who sent it, if it is of all nodes, else that of the last
/// @param from who has sent it
/// @param deadline nobody is asked after it
void send_on(SentStop& stop, std::uint8_t from, std::chrono::steady_clock::time_point deadline, const SendStop& send,
             const NextSender& next = next_sender);

/// Bytes that the line into a node has carried: what came in without the framing of the link, which is no part of the
/// ring's data rate.
/// @param counter value of a node's counter, by its name
template <class Counter>
std::uint64_t line_bytes_in(Counter counter) {
  const std::uint64_t all = counter("input_bytes");
  const std::uint64_t framing = wire::kSliceHeaderSize * (counter("input_slices") + counter("input_idle_slices"));
  return all - std::min(all, framing);
}

}  // namespace limb_ring::ask
