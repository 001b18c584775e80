#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "comparison/network.h"

namespace limb_ring::study {

using namespace std::chrono_literals;

constexpr Duration d = 512ns;  ///< how long each node of gigabit() holds what it passes on

/// 1 Gbit/s, so that a bit is 1 ns and a byte 8 ns; d = 512 ns.
inline Medium gigabit(unsigned nodes, unsigned payload = 512) {
  Medium medium;
  medium.nodes = nodes;
  medium.payload = payload;
  return medium;
}

inline Message data(Duration asked, std::uint8_t source, std::uint8_t destination, unsigned size,
                    std::uint8_t priority = 0) {
  return {Time{} + asked, NodeId{source}, NodeId{destination}, size, priority, false};
}

inline Message interrupt(Duration asked, std::uint8_t source, std::uint8_t destination) {
  return {Time{} + asked, NodeId{source}, NodeId{destination}, 0, 0, true};
}

/// When each message was delivered, counted from time zero. All of them must be.
inline std::vector<Duration> deliveries(const Network& network, const Medium& medium,
                                        const std::vector<Message>& messages) {
  std::vector<Duration> out;
  for (const Time at : network.carry(medium, messages, core::kNever)) {
    EXPECT_NE(at, core::kNever);
    out.push_back(at - Time{});
  }
  return out;
}

inline Duration delivery(const Network& network, const Medium& medium, const Message& message) {
  return deliveries(network, medium, {message}).front();
}

/// Every node one message to the node `hops` behind it, at time zero.
inline std::vector<Message> all_to(const Medium& medium, unsigned hops) {
  std::vector<Message> messages;
  for (unsigned id = 0; id < medium.nodes; ++id) {
    const auto destination = static_cast<std::uint8_t>((id + hops) % medium.nodes);
    messages.push_back(data(0ns, static_cast<std::uint8_t>(id), destination, medium.payload));
  }
  return messages;
}

inline Duration worst(const std::vector<Duration>& times) { return *std::max_element(times.begin(), times.end()); }

}  // namespace limb_ring::study
