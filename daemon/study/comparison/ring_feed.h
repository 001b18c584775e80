#pragma once

#include <array>
#include <deque>
#include <map>
#include <tuple>
#include <vector>

#include "sim/virtual_ring.h"
#include "study/comparison/network.h"

namespace limb_ring::study {

/// Gives messages to a virtual ring as they are asked for and notes when they come out. A message for which a
/// node's own queue has no room waits here, in order, so that the queue's limit does not change the latency.
class RingFeed {
 public:
  /// Message times count from ring.now(). Takes the ring's callbacks; both must outlive this.
  RingFeed(sim::VirtualRing& ring, const std::vector<Message>& messages);
  RingFeed(const RingFeed&) = delete;
  RingFeed& operator=(const RingFeed&) = delete;

  bool done() const { return open_ == 0; }
  /// For each message, counted from the start; core::kNever: not by `until`.
  std::vector<Time> delivered(Time until) const;

 private:
  struct Queue {
    std::deque<std::size_t> outside;
    unsigned inside = 0;
  };
  struct Node {
    std::array<Queue, kMessageClasses> queues;  ///< the core, too, has one for each
    std::map<std::uint32_t, std::size_t> class_of_token;
  };
  using Flow = std::tuple<NodeId, NodeId, std::size_t>;  ///< source, destination, class

  void ask_at_next();
  void ask(std::size_t message);
  void feed(NodeId node, std::size_t kind);
  std::uint32_t send(const Message& message);
  void ended(NodeId node, const core::SendEnded& end);
  void came(const Flow& flow, Time at);

  sim::VirtualRing& ring_;
  const std::vector<Message>& messages_;
  const Time start_;
  std::size_t next_ = 0, open_;
  std::vector<Node> nodes_;
  std::map<Flow, std::deque<std::size_t>> under_way_;  ///< the ring keeps the order within a flow
  std::vector<Time> at_;
};

}  // namespace limb_ring::study
