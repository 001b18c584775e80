#pragma once

#include <map>
#include <string>

#include "config/fault_parse.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// Whoever has the nodes of a virtual ring.
class NodePower {
 public:
  virtual ~NodePower() = default;
  /// The node is dead: as SIGKILL of its daemon, and its neighbours bypass it.
  virtual void off(wire::NodeId node) = 0;
  /// A dead node comes up. @return why not; empty: it does
  virtual std::string on(wire::NodeId node) = 0;
  /// The node stands still, and is bypassed; later it goes on where it stood.
  virtual void freeze(wire::NodeId node) = 0;
  virtual void thaw(wire::NodeId node) = 0;
};

/// Faults of whole nodes of a virtual ring: kill, start, power_cycle, freeze, thaw. What holds is noted in the ring's
/// folder, as on a live ring (io/node_notes.h), for all who do not get an answer from the node. (ours)
class NodeFaults {
 public:
  /// The notes of an earlier ring are removed. @param ring, power outlive this
  NodeFaults(sim::VirtualRing& ring, NodePower& power, fault::RingNodes nodes, std::string folder);

  /// Does it at this instant, to all of its nodes or to none. A node frozen for a time is thawed by the ring's clock.
  /// @pre a fault of nodes, and no program acts: called from an action of the ring (VirtualRing::at)
  /// @return why not; empty: it is done
  std::string begin(const fault::Fault& fault);

  bool is_dead(wire::NodeId node) const { return state(node) == State::dead; }
  bool is_frozen(wire::NodeId node) const { return state(node) == State::frozen; }

 private:
  enum class State { runs, frozen, dead };
  struct Node {
    State state = State::runs;
    unsigned freezes = 0;
  };

  State state(wire::NodeId node) const;
  std::string why_not(fault::Name what, wire::NodeId node) const;
  std::string carry_out(const fault::Fault& fault);
  std::string power_cycle(const fault::Fault& fault);
  std::string start(wire::NodeId node);
  void kill(wire::NodeId node);
  void freeze(wire::NodeId node, const fault::Fault& fault);
  void thaw(wire::NodeId node);
  std::string note(const fault::Fault& fault) const;
  void forget_new_notes(const fault::Fault& fault) const;
  const std::string& name_of(wire::NodeId node) const;

  sim::VirtualRing& ring_;
  NodePower& power_;
  fault::RingNodes nodes_;
  std::string folder_;
  std::map<wire::NodeId, Node> states_;
};

}  // namespace limb_ring::virtual_host
