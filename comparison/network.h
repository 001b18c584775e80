#pragma once

#include <cstddef>
#include <random>
#include <stdexcept>
#include <vector>

#include "study/model_ring.h"

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

// What the methods are given to carry. All times and nodes are drawn from the generator with integer
// arithmetic of our own: the same seed gives the same list on every machine. (ours)

using Random = std::mt19937_64;

/// Uniform in [0, below). @pre below > 0
std::uint64_t draw(Random& random, std::uint64_t below);

/// To whom a node sends.
enum class Destination {
  opposite,  ///< half the ring away, rounded down
  random     ///< any other node, each equally likely
};

/// One message of one node, priority 0, B bytes.
Message message(const Medium& medium, Time asked, NodeId source, Destination destination, Random& random);

/// Every node asks for `each` messages at the same instant.
std::vector<Message> all_at_once(const Medium& medium, Time asked, unsigned each, Destination destination,
                                 Random& random);

/// Random arrivals within [from, from + span): as many as offer `load` times R of payload, each at a
/// uniform moment and node, to a random destination: Poisson arrivals, given their number.
std::vector<Message> random_load(const Medium& medium, double load, Time from, Duration span, Random& random);

/// `count` interrupt-like messages from random nodes to random others, added to `load` in order: one in
/// every `gap`, at a random moment of its first half, so that they seldom meet each other.
std::vector<Message> with_interrupts(std::vector<Message> load, const Medium& medium, unsigned count, Duration gap,
                                     Random& random);

/// When each message was delivered, as Network::carry() returns it.
class Deliveries {
 public:
  Deliveries(std::size_t messages, Time until) : at_(messages, core::kNever), open_(messages), until_(until) {}

  /// @throw std::logic_error if that message was delivered before: the model is wrong
  void put(std::size_t message, Time at) {
    if (at_[message] != core::kNever) throw std::logic_error("a message was delivered twice");
    --open_;
    at_[message] = at;
  }
  /// Whether anything can still be delivered by `until`.
  bool go_on(Time now) const { return open_ > 0 && now <= until_; }
  /// By message; what was delivered after `until` counts as not delivered.
  std::vector<Time> result() const {
    std::vector<Time> out = at_;
    for (Time& at : out)
      if (at > until_) at = core::kNever;
    return out;
  }

 private:
  std::vector<Time> at_;
  std::size_t open_;
  Time until_;
};

}  // namespace limb_ring::study
