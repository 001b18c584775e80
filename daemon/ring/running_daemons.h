#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config/fault_parse.h"
#include "config/node_row.h"
#include "io/child.h"
#include "limb_ring/host_port.h"
#include "ring/observed_daemon.h"
#include "ring/ring_files.h"

namespace limb_ring::live {

/// The daemons of one ring on this host: they are asked through their host ports, signalled, and started again.
/// Every call ends by a deadline. @throw NotDone with the node's name and what is wrong, HostPortError if its daemon
/// is not there
class RunningDaemons {
 public:
  static constexpr std::chrono::milliseconds kComesUp{20'000};  ///< a node may take so long

  RunningDaemons(std::string ring, fault::RingNodes nodes);

  const fault::RingNodes& nodes() const { return nodes_; }
  std::vector<wire::NodeId> node_ids() const;
  const fault::NamedNode& node(wire::NodeId id) const;
  const std::string& folder() const { return folder_; }
  Holder holder(wire::NodeId node) const { return holder_of(folder_, node); }
  bool is_frozen(wire::NodeId node) const;

  /// @throw HostPortError if its daemon does not
  void require_runs(wire::NodeId node) const;
  HostPort connect(wire::NodeId node) const;
  nlohmann::json ask(wire::NodeId node, const nlohmann::json& request) const;
  /// The same if the answer comes once the node's CPU has booted: it may take as long as the ring's file says.
  nlohmann::json ask_for_boot(wire::NodeId node, const nlohmann::json& request) const;

  /// One process has all nodes, on a virtual clock.
  bool is_virtual() const { return holder(nodes_.front().id).on_virtual_ring; }
  /// Sends that process a request that concerns the ring as a whole. @pre is_virtual()
  nlohmann::json ask_ring(const nlohmann::json& request) const;
  /// That process goes on, if somebody has stopped it: no fault does, which is of a node. @pre is_virtual()
  void wake_ring() const;

  /// On a virtual ring the following four are done to the node in the simulation.
  /// SIGKILL; gone when this returns.
  void kill(wire::NodeId node) const;
  /// SIGSTOP and SIGCONT, only for the daemon: its CPU goes on.
  void freeze(wire::NodeId node) const;
  /// It can be asked again when this returns, unless that takes it more than a few seconds.
  void thaw(wire::NodeId node) const;
  /// With the arguments of its last start, in a session of its own, with a log file in the ring's folder. As
  /// wait_for_hello(); NotDone at once if the daemon ends instead.
  void start(wire::NodeId node, std::chrono::milliseconds patience = kComesUp) const;
  /// As if its power went off and on; same pid. Then as wait_for_hello(); NotDone at once if the daemon ends
  /// instead.
  void power_cycle(wire::NodeId node) const;
  /// Returns when the node has said hello. @throw NotDone if it has not within `patience`, or its daemon has ended
  void wait_for_hello(wire::NodeId node, std::chrono::milliseconds patience = kComesUp) const;

 private:
  HostPortError no_daemon(wire::NodeId node) const;
  bool wait_while_it_lives(wire::NodeId node, const std::function<bool()>& condition,
                           std::chrono::milliseconds patience) const;
  status::NodeRow row_of(wire::NodeId node) const;
  bool has_joined(wire::NodeId node) const;
  nlohmann::json ask_through(HostPort& port, const nlohmann::json& request, std::chrono::milliseconds timeout) const;
  bool done_in_virtual_ring(fault::Name what, wire::NodeId node) const;
  pid_t pid_here(wire::NodeId node) const;
  void signal(wire::NodeId node, int number) const;
  void keep(process::Child daemon) const;

  std::string ring_;
  fault::RingNodes nodes_;
  std::string folder_;
  mutable std::mutex mutex_;
  mutable std::vector<process::Child> started_;  ///< here; a start reaps those that have ended, else they stay zombies
};

/// Whether `address`, which must be numeric, is this machine's own: a process here can bind to it. (ours)
bool is_own_address(const std::string& address);

}  // namespace limb_ring::live
