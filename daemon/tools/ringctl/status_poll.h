#pragma once

#include <functional>

#include "tools/ringctl/answers.h"
#include "tools/ringctl/top_table.h"

namespace limb_ring::ringctl {

/// Asks all nodes for their status, over connections that it keeps, and observes them on these if asked to.
class StatusPoll {
 public:
  /// What the node at that place of the ring is to be observed by (HostPort::observe()). Called by several threads.
  using Order = std::function<std::string(std::size_t node)>;
  /// What came from that node and is no status row.
  using Seen = std::function<void(std::size_t node, const Message& message)>;

  explicit StatusPoll(const RingAccess& ring, Order order = {}, Seen seen = {});

  /// The rows of all nodes, now; daemons that do not answer delay it by 500 ms, or 10 ms a node if that is more.
  StatusSample sample();
  /// Hands over what is observed until then.
  void listen(std::chrono::steady_clock::time_point until);
  bool is_connected(std::size_t node) { return client_.port(node) != nullptr; }
  /// Gives a node that is connected its order again.
  void observe(std::size_t node);

 private:
  std::vector<ask::ToldRow> round(bool with_heard);
  void drain(std::size_t index);

  const RingAccess& ring_;
  Order order_;
  ask::RingClient client_;
  bool wants_heard_ = false;  ///< a node did not answer: what the others have heard of it tells its state
};

}  // namespace limb_ring::ringctl
