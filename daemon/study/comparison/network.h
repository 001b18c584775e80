#pragma once

#include <cstddef>
#include <vector>

#include "study/analysis/medium.h"

namespace limb_ring::study {

/// What a CPU asks a network to carry.
struct Message {
  Time asked{};
  NodeId source{0}, destination{0};
  unsigned size = 0;          ///< bytes of data
  std::uint8_t priority = 0;  ///< 0 (highest) to 3
  bool interrupt = false;     ///< to be carried the fastest way the method has; no data
};

/// What waits apart in every node: interrupt-like messages (0), then data by priority (1 to 4). (ours)
constexpr std::size_t kMessageClasses = 5;
inline std::size_t class_of(const Message& message) { return message.interrupt ? 0 : 1u + message.priority; }

/// A method of sharing a line between nodes, on a virtual clock: messages in, times out.
class Network {
 public:
  virtual ~Network() = default;
  /// Carries `messages`, which are in the order of `asked`, with the network idle and running at
  /// time zero. @return for each, when its last bit was delivered; core::kNever: not by `until`
  virtual std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const = 0;
  /// From power-on of one more node in a running, fully loaded network of medium.nodes nodes, to
  /// the moment at which it may first send.
  virtual Duration time_to_join(const Medium& medium) const = 0;
};

}  // namespace limb_ring::study
