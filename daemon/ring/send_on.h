#pragma once

#include <functional>

#include "ring/known_stops.h"

namespace limb_ring::ask {

/// Sends a stop from the node with this id, and waits for its result, at most so long.
/// @return it was delivered. Where it throws, nothing is known of that node.
using SendStop = std::function<bool(std::uint8_t from, std::chrono::milliseconds timeout)>;
/// Who should send the stop next, where it was not sent by these.
using NextSender =
    std::function<std::optional<std::uint8_t>(const SentStop& stop, const std::set<std::uint8_t>& senders)>;

/// Of nodes whose daemon is on this host, as far as they say now what was not reached.
std::optional<std::uint8_t> next_sender(const SentStop& stop, const std::set<std::uint8_t>& senders);

/// Has other nodes send a stop that one has sent, one after the other, until all that can be reached were reached: in
/// an open chain, or a ring that has folded into parts, one node does not reach all.
/// @param stop its `delivered` is that of all who sent it, where it is of all nodes, else that of the last
/// @param from who has sent it
/// @param deadline nobody is asked after it
void send_on(SentStop& stop, std::uint8_t from, std::chrono::steady_clock::time_point deadline, const SendStop& send,
             const NextSender& next = next_sender);

}  // namespace limb_ring::ask
