#pragma once

#include <functional>
#include <optional>

#include "io/node_notes.h"
#include "ring/running_daemons.h"

namespace limb_ring::live {

/// The fault of a whole node, as noted in the ring's folder: its id is its word. A note stays, out of date, if
/// somebody else has ended its fault: it counts for nothing then.
std::optional<status::Fault> noted_fault(const std::string& folder, wire::NodeId node);

/// All faults that last, in ring order.
struct FaultList {
  std::vector<status::Fault> faults;  ///< their ids: NODE.NUMBER, or NODE.freeze, NODE.suspend, NODE.kill
  std::vector<std::string> unknown;   ///< for each daemon that runs and does not tell of its own: whose, and why
};

/// What has been done.
struct Begun {
  std::string id;     ///< empty if it is over at once: heal, start, thaw, power_cycle, resume, reset, crash
  std::string words;  ///< as in status::Fault; a seed that was drawn is among them
};

/// Breaks a living ring on purpose, and mends it. Faults of lines and CPUs are kept by the daemon at the node
/// where they are, faults of whole nodes by notes in the ring's folder. Every call returns when it has taken
/// effect, by a deadline; one that freezes for a time when that is over, on a virtual ring by its clock, which may
/// stand. (ours)
class LiveFaults {
 public:
  LiveFaults(const std::string& ring, const fault::RingNodes& nodes) : daemons_(ring, nodes) {}

  /// Waits for that time, or less. @return whether somebody asks to end; then a node frozen for a time is thawed at
  /// once
  using Wait = std::function<bool(std::chrono::milliseconds)>;

  /// A node frozen for a time is thawed again when this returns.
  /// @param wait may be called by several threads at a time; empty: nobody asks to end
  /// @return one for each of its nodes. @throw NotDone, HostPortError if a daemon is not there
  std::vector<Begun> begin(const fault::Fault& fault, const Wait& wait = {}) const;
  /// Of a daemon that does not answer, only that it is frozen or killed.
  FaultList list() const;
  /// A frozen daemon is thawed, a killed one is started.
  /// @throw NotDone if there is no such fault, fault::ParseError if there can be none
  void remove(const std::string& id) const;
  /// Removes all faults. @return what could not be done, one line each; empty: no fault is left
  /// @param patience for what is started to come up
  std::vector<std::string> clear(std::chrono::milliseconds patience = RunningDaemons::kComesUp) const;

 private:
  std::vector<Begun> begin_on_virtual_ring(const fault::Fault& fault, const Wait& wait) const;
  Begun begin_at(const fault::Fault& fault, wire::NodeId node, const Wait& wait) const;
  NodeNote note(wire::NodeId node, const std::string& words) const;
  NodeNote begin_noted(fault::Name what, wire::NodeId node, const std::string& words) const;
  void begin_at_node(const fault::Fault& fault, wire::NodeId node) const;
  Begun begin_at_daemon(const fault::Fault& fault, wire::NodeId node) const;
  void wait_until_thawed(wire::NodeId node, const Wait& wait) const;
  void wait_and_thaw(std::chrono::nanoseconds lasts, wire::NodeId node, const NodeNote& ours, const Wait& wait) const;
  void revive(wire::NodeId node, std::chrono::milliseconds patience = RunningDaemons::kComesUp) const;
  void clear_at(wire::NodeId node, std::chrono::milliseconds patience) const;
  std::optional<status::Fault> node_fault(wire::NodeId node) const;
  std::vector<status::Fault> faults_of(wire::NodeId node) const;
  wire::NodeId node_of(const std::string& id) const;

  RunningDaemons daemons_;
};

}  // namespace limb_ring::live
