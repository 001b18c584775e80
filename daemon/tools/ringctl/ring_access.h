#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "limb_ring/host_port.h"
#include "ring/status_rows.h"
#include "tools/ringctl/connect_node.h"
#include "tools/ringctl/node_name.h"

namespace limb_ring::ringctl {

/// Until when answers are waited for; by itself until each daemon has had its time.
using Deadline = std::chrono::steady_clock::time_point;
constexpr Deadline kNoDeadline = Deadline::max();

/// A machine that runs some of the nodes.
struct RingHost {
  std::string name, address;
  std::string ssh;  ///< where ssh finds it
};

/// All daemons of the ring that live are frozen.
struct AllFrozen : NoRing {
  using NoRing::NoRing;
};

/// A running ring, as one of its daemons describes it.
struct RingDescription {
  std::string ring;
  std::vector<NodeName> nodes;          ///< in ring order; at least one
  std::size_t answered = 0;             ///< place in `nodes` of the one whose daemon said all this
  std::vector<RingHost> hosts;          ///< none where the ring's file gives none
  std::string path;                     ///< of the ring's YAML file; may be empty
  bool folds_back = false;              ///< it has a second line
  std::chrono::milliseconds beacon{0};  ///< time between two beacons of a node; 0: unknown
};

/// Access to a running ring: which nodes it has, and connections to those of this host.
class RingAccess {
 public:
  /// Asks `first` (id or name; may be empty), then one daemon after the other that is not frozen, how the ring is
  /// configured; where one keeps us waiting, all at the same time. @throw NoRing where none answers, AllFrozen where
  /// none could
  static RingAccess open(const std::string& ring, const std::string& first = {}, Deadline deadline = kNoDeadline);
  /// As open(). Where none answers, because nodes were killed or frozen on purpose, the nodes of this host by what
  /// their files tell, in the order of their ids.
  static RingAccess open_also_dead(const std::string& ring);
  explicit RingAccess(RingDescription ring) : ring_(std::move(ring)) {}

  const std::string& ring() const { return ring_.ring; }
  const std::string& path() const { return ring_.path; }
  bool folds_back() const { return ring_.folds_back; }
  std::chrono::milliseconds beacon() const { return ring_.beacon; }
  const std::vector<NodeName>& nodes() const { return ring_.nodes; }
  std::vector<ask::Node> ask_nodes() const;  ///< the same for daemon/ring

  const std::vector<RingHost>& hosts() const { return ring_.hosts; }
  const std::string& here() const { return answered().host; }  ///< this host; empty where there are none
  bool is_elsewhere(const NodeName& node) const { return node.host != here(); }
  std::vector<NodeName> nodes_here() const;
  /// @throw Elsewhere where it is on another host
  void require_here(const NodeName& node) const;

  /// @throw UsageError listing the nodes there are
  const NodeName& node(const std::string& id_or_name) const;
  /// Id of a node, or kBroadcast for "all". @throw UsageError
  std::uint8_t destination(const std::string& id_or_name_or_all) const;
  /// As node(); for an empty text the node that described the ring.
  const NodeName& source(const std::string& id_or_name) const;
  /// @throw HostPortError, Elsewhere
  HostPort connect(const NodeName& node, Stay stay = Stay::asks_only) const;

 private:
  const NodeName& answered() const { return ring_.nodes[ring_.answered]; }

  RingDescription ring_;
};

}  // namespace limb_ring::ringctl
