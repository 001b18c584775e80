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
class RingAccess {
 public:
  /// Asks `first` (id or name; may be empty), then one daemon after the other, how the ring is
  /// configured. @throw NoRing where none answers
  static RingAccess open(const std::string& ring, const std::string& first = {});
  /// As open(). Where none answers, because nodes were killed or frozen on purpose, the nodes of this host by what
  /// their files tell, in the order of their ids.
  static RingAccess open_also_dead(const std::string& ring);
  /// `answered`: index of the node that said all this.
  RingAccess(std::string ring, std::string path, bool folds_back, std::chrono::milliseconds beacon,
             std::vector<NodeName> nodes, std::size_t answered, std::vector<RingHost> hosts = {});

  const std::string& ring() const { return ring_; }
  const std::string& path() const { return path_; }              ///< of its YAML file; may be empty
  bool folds_back() const { return folds_back_; }                ///< it has a second line
  std::chrono::milliseconds beacon() const { return beacon_; }   ///< time between two beacons of a node
  const std::vector<NodeName>& nodes() const { return nodes_; }  ///< in ring order
  std::vector<ask::Node> ask_nodes() const;                      ///< the same for daemon/ask

  const std::vector<RingHost>& hosts() const { return hosts_; }       ///< none where the file gives none
  const std::string& here() const { return nodes_[answered_].host; }  ///< this host; empty where there are none
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
  std::string ring_, path_;
  bool folds_back_;
  std::chrono::milliseconds beacon_;
  std::vector<NodeName> nodes_;
  std::size_t answered_;
  std::vector<RingHost> hosts_;
};

/// ": Permission denied" where that folder is another user's; empty where it can be read, or is not there.
std::string why_unreadable(const std::string& folder);

/// The daemon at the other end has gone: which one, and why.
HostPortError gone(const HostPort& port, const std::string& reason);

/// Connects to a daemon that is there, or not at all. @throw HostPortError
HostPort connect_node(const std::string& ring, const std::string& node);

}  // namespace limb_ring::ringctl
