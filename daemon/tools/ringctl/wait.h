#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/ringctl/status_rows.h"
#include "tools/ringctl/up.h"

namespace limb_ring::ringctl {

/// Says in words what is still missing in the status rows; empty if the wait is over.
using Lack = std::function<std::string(const Rows& rows)>;

/// What keeps the ring from being whole. It is whole when every node is up in a ring of all nodes, not folded back; its
/// second line, if it has one, is connected; and every CPU that its ringd starts runs.
std::string lack_of_whole(const Rows& rows);

/// A node's state, or its CPU's, in the words of `ringctl status`.
/// @return what they are instead; empty if one of them is `state`. @throw UsageError if there is no such node
std::string lack_of_state(const Rows& rows, const std::string& node, const std::string& state);

/// All words that lack_of_state() knows.
std::vector<std::string> state_words();

/// Asks until nothing is lacking; a ring that does not run yet may come.
/// @param ring its name; empty: the only one running
/// @return what was lacking at the end: after `timeout`, or when somebody asked for it (Ctrl-C); empty: nothing
/// @throw what `lack` throws
std::string wait_for(const std::string& ring, std::chrono::milliseconds timeout, const Lack& lack);

/// What a node still lacks, by its status row, before the ring of so many nodes counts as whole: it has to be up in a
/// ring of all of them, its second line, if it has one, to be connected, and its CPU to run if that is a child of
/// ringd. Empty if nothing.
std::string lack_of_node(const status::NodeRow& row, std::size_t nodes);
/// The same for one host's part of a ring, while other hosts may still be missing: the node has to be in a ring of at
/// least this host's `nodes`, or in an open chain.
std::string lack_in_part(const status::NodeRow& row, std::size_t nodes);

/// Watches a ring that is being started, over connections that it keeps.
class RingWatch {
 public:
  explicit RingWatch(const RingPlan& plan);

  struct NotReady {
    std::size_t index;  ///< of the node, in ring order
    std::string lack;   ///< "node 3 (left_knee): it is joining"
  };
  /// The first node that is not ready; nothing if the ring is closed.
  std::optional<NotReady> first_not_ready();
  /// How many nodes the ring had, as far as the nodes here knew when they were asked last.
  std::size_t ring_size() const { return ring_size_; }
  /// Why a node will never get into the ring, as any node told that answered last, behind "; "; empty if none said so.
  const std::string& refusal() const { return refusal_; }

 private:
  const RingPlan& plan_;
  ask::RingClient client_;
  std::size_t ring_size_ = 0;
  std::string refusal_;
};

}  // namespace limb_ring::ringctl
