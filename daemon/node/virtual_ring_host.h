#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <ostream>
#include <vector>

#include "client/host_message.h"
#include "config/fault_parse.h"
#include "io/packet_loop.h"
#include "node/host_server.h"
#include "node/library_node.h"
#include "node/lockstep.h"
#include "node/node.h"
#include "node/node_driver.h"
#include "node/node_folder.h"
#include "node/steering.h"
#include "node/virtual_node.h"
#include "sim/planned_ring.h"
#include "sim/trace.h"

namespace limb_ring::virtual_host {

/// What can be asked of a virtual ring as a whole.
struct RingRequests {
  /// Does a fault of nodes; `done` is called once, with why not, or with nothing.
  std::function<void(const fault::Fault&, std::function<void(const std::string& problem)> done)> fault;
  runtime::ClockControl& clock;
};

/// The host port of a virtual ring itself, ALL.host where its nodes have ID.host (ALL: wire::kBroadcast): it answers
/// also while nodes are dead or frozen. It has no CPU and sends nothing; requests alone (docs/reference/requests.md).
class RingPort final : private host::HostHandler {
 public:
  /// @param nodes those of the ring. @throw std::exception if the socket cannot be had
  RingPort(boost::asio::io_context& io, host::HostOptions options, fault::RingNodes nodes, RingRequests requests);

  void close();

 private:
  std::optional<std::string> on_attach(const host::ClientInfo& client) override;
  void on_detach(const host::ClientInfo&) override {}
  void on_send(host::ClientId client, const client::SendRequest& request) override;
  void on_interrupt(host::ClientId client, const client::InterruptRequest& request) override;
  void on_pull(host::ClientId client, const client::PullRequest& request) override;
  void on_request(host::ClientId client, const client::JsonRequest& request) override;
  void on_observe(host::ClientId client, const client::ObserveRequest& request) override;
  void on_alive(host::ClientId) override {}
  void on_credit(host::ClientId) override {}

  nlohmann::json state() const;
  void begin_fault(const nlohmann::json& request, const std::function<void(const nlohmann::json&)>& answer);
  void reject(host::ClientId client, std::uint32_t token);

  fault::RingNodes nodes_;
  RingRequests requests_;
  host::HostServer host_;
  runtime::FolderWatch watch_;
};

/// What a virtual ring with host ports is told beside the ring's file.
struct VirtualRingHostOptions {
  std::uint64_t line_fault_seed = 0;  ///< of faults that come without a seed
  int cpu_output = -1;                ///< descriptor for what CPUs print; -1: as this process
  bool libraries = false;             ///< foreign nodes run their own code, if the file names it (LibraryNode)
};

/// A whole ring in one process, on a virtual clock: its lines are simulated, its nodes have the host ports and CPUs of
/// daemons, for the same clients.
class VirtualRingHost final : private sim::Observer, private NodePower {
 public:
  /// @param ring every line has a rate; all outlive this
  /// @throw std::exception if a node is held by another process, or a socket cannot be had
  VirtualRingHost(boost::asio::io_context& io, const config::RingConfig& ring,
                  const VirtualRingHostOptions& options = {});
  ~VirtualRingHost() override;

  /// Writes all packets on its lines there, as pcapng, in its time. @param out outlives this
  void capture(std::ostream& out);
  /// Starts the CPUs.
  void start();
  /// Lets time go on, no faster than `pace`, until the event loop is stopped; at `end`, stop() is called.
  void run(Pace& pace, core::Time end);
  /// To be called before it runs: time then goes on no further than a client allows.
  void follow() { steering_.follow(); }
  /// Runs as fast as possible until `done`, asked at every instant, returns true; until `end`, when all programs have
  /// done what they do then; or until the event loop is stopped. @return what `done` said last
  bool run_until(const std::function<bool()>& done, core::Time end);
  /// Ends everything cleanly; `done` is called from the event loop.
  void stop(const std::function<void()>& done);

  /// Calls `action` at that instant of the ring's time, while no program acts.
  void at(core::Time when, std::function<void()> action);
  /// Does a fault now, of whatever it is. @pre within an action, see at(); if it takes a seed, it has one
  /// @param done told for each of its nodes, perhaps later, why not, or nothing; a reset is done when the CPU has
  /// booted
  void begin(const fault::Fault& fault, const std::function<void(const std::string& problem)>& done);
  /// Dead or frozen ones.
  const NodeFaults& node_faults() const { return *node_faults_; }
  /// Does a fault of nodes at this instant, as soon as no program acts; `done` is told why not, or nothing.
  void begin_at_nodes(const fault::Fault& fault, std::function<void(const std::string& problem)> done);
  /// The state, pid or counts of a CPU have changed.
  std::function<void(std::uint8_t node, const runtime::CpuStatus&)> on_cpu_changed = [](std::uint8_t,
                                                                                        const runtime::CpuStatus&) {};

  core::Time now() const { return ring_.now(); }
  /// Of all that happened on the ring.
  std::uint64_t trace_hash() const { return trace_.hash(); }
  /// Why this run is not repeatable; empty if no reason is known.
  std::string not_repeatable() const;
  Lockstep& lockstep() { return lockstep_; }
  const Lockstep& lockstep() const { return lockstep_; }
  sim::VirtualRing& ring() { return ring_; }
  sim::VirtualLineFaults& line_faults() { return faults_; }
  /// Null if it is dead, or a LibraryNode.
  runtime::Node* node(wire::NodeId id) {
    const auto found = nodes_.find(id);
    return found == nodes_.end() ? nullptr : found->second.get();
  }

 private:
  void add(const config::NodeConfig& node);
  LibraryNode* library(wire::NodeId id);
  runtime::NodeBase base_of(const config::NodeConfig& node);
  void off(wire::NodeId node) override;
  std::string on(wire::NodeId node) override;
  void freeze(wire::NodeId node, bool clock_stands) override;
  void thaw(wire::NodeId node) override;
  void arrives(wire::NodeId node, const wire::Slice& slice, core::Time now) override;
  void leaves(wire::NodeId node, const wire::Slice& slice, core::Time now) override;
  void input_changes(wire::NodeId node, core::Line line, core::Time now) override;
  void incident(wire::NodeId node, sim::Incident incident, core::Time now, core::Line line) override;

  /// @return true if time may go on: no program acts, none is due for a turn, and none that boots or ends is waited for
  bool all_wait();
  void advance(core::Time until, const std::function<bool()>& done);
  /// Waits for the next event of the event loop, or until real time reaches `when`.
  void sleep_until(Pace::Real when);
  void look_at_lines();

  boost::asio::io_context& io_;
  const config::RingConfig& config_;
  VirtualRingHostOptions options_;
  sim::VirtualRing ring_;
  sim::VirtualLineFaults faults_;
  std::vector<VirtualNode*> drivers_;  ///< by id; null if there is none, or a LibraryNode
  std::map<std::uint8_t, std::shared_ptr<runtime::NodeFolder>> folders_;  ///< a dead node is held all the same
  std::map<std::uint8_t, std::unique_ptr<runtime::Node>> nodes_;          ///< those that are not dead
  std::map<std::uint8_t, std::unique_ptr<LibraryNode>> libraries_;
  Lockstep lockstep_;
  Steering steering_;
  sim::Trace trace_;
  std::optional<NodeFaults> node_faults_;
  std::optional<RingPort> port_;
  std::optional<sim::RingCapture> capture_;
  event_loop::PacketTimer wake_;
  bool lines_changed_ = true;
  bool stopping_ = false;
};

}  // namespace limb_ring::virtual_host
