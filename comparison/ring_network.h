#pragma once

#include <array>
#include <deque>
#include <functional>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "comparison/network.h"
#include "sim/virtual_ring.h"

namespace limb_ring::study {

/// Our ring as a method among others: the core of the daemon, sim::VirtualRing, with lines of rate R
/// and relay delay d, beacons off, joined before time zero. (ours; protocol.md section 7.2)
///
/// Delivered is what the destination's controller has in its receive buffer with a good CRC; an
/// interrupt-like message is an INTP, delivered when the pin is pulled.
class RingNetwork : public Network {
 public:
  /// @param goes_on called now and then while it is at work: large rings take long
  explicit RingNetwork(std::function<void()> goes_on = [] {}) : goes_on_(std::move(goes_on)) {}

  /// @throw std::runtime_error if the ring does not close: the settings are wrong
  std::vector<Time> carry(const Medium& medium, const std::vector<Message>& messages, Time until) const override;
  /// Until the hello is home: the longest time for several moments spread over a lap. The links are moved,
  /// and packets that are on them at that moment are lost and sent again by their sources.
  /// @throw std::runtime_error as above
  Duration time_to_join(const Medium& medium) const override;

 private:
  /// @param wait in full load, before the newcomer is switched on
  Duration time_to_join_after(const Medium& medium, Duration wait) const;

  std::function<void()> goes_on_;
};

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
