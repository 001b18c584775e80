#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/ringctl/problems.h"
#include "ask/status_rows.h"
#include "limb_ring/host_port.h"

namespace limb_ring::ringctl {

/// A node as a running ring tells of it.
struct NodeName {
  std::uint8_t id = 0;
  std::string name;
  std::string host = {};  ///< empty where the ring's file gives no hosts
};

/// A machine that runs some of the nodes.
struct RingHost {
  std::string name, address;
  std::string ssh;  ///< where ssh finds it
};

/// "12 (left_knee)"
std::string label(const NodeName& node);

/// What is wrong with a node that the ring has not, with a guess and those it has.
UsageError unknown_node(const std::string& word, const std::string& ring, const std::vector<NodeName>& nodes);

/// The ring meant: the one given, else the environment's LIMB_RING_RING, else the only one
/// running, else the only one that is dead because its daemons were killed on purpose.
/// @throw NoRing where there is none; UsageError listing them where several run.
std::string choose_ring(const std::string& given);

/// Ids of the nodes whose daemon has a socket in the ring's folder, answering or not, sorted.
std::vector<std::uint8_t> node_sockets(const std::string& ring);

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
  /// Asks `first` (id or name; may be empty), then one daemon after the other, how the ring is
  /// configured. @throw NoRing where none answers
  static RingAccess open(const std::string& ring, const std::string& first = {});
  /// As open(). Where none answers, because nodes were killed or frozen on purpose, the nodes of this host by what
  /// their files tell, in the order of their ids.
  static RingAccess open_also_dead(const std::string& ring);
  explicit RingAccess(RingDescription ring) : ring_(std::move(ring)) {}

  const std::string& ring() const { return ring_.ring; }
  const std::string& path() const { return ring_.path; }
  bool folds_back() const { return ring_.folds_back; }
  std::chrono::milliseconds beacon() const { return ring_.beacon; }
  const std::vector<NodeName>& nodes() const { return ring_.nodes; }
  std::vector<ask::Node> ask_nodes() const;  ///< the same for daemon/ask

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
  HostPort connect(const NodeName& node) const;

 private:
  const NodeName& answered() const { return ring_.nodes[ring_.answered]; }

  RingDescription ring_;
};

/// ": Permission denied" where that folder is another user's; empty where it can be read, or is not there.
std::string why_unreadable(const std::string& folder);

/// The daemon at the other end has gone: which one, and why.
HostPortError gone(const HostPort& port, const std::string& reason);

/// Connects to a daemon that is there, or not at all. @throw HostPortError
HostPort connect_node(const std::string& ring, const std::string& node);

}  // namespace limb_ring::ringctl
