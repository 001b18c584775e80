#pragma once

#include <sched.h>

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "config/ring_config.h"
#include "node/cpu_socket.h"
#include "node/event_router.h"
#include "node/faults.h"
#include "node/host_server.h"
#include "node/node_driver.h"
#include "node/node_folder.h"
#include "node/observers.h"
#include "node/pin_board.h"
#include "node/requests.h"
#include "node/send_reason.h"

namespace limb_ring::runtime {

/// What the clients of the host port call for: sends go to the network controller, requests to Requests, what
/// concerns the CPU to its socket.
class ClientCalls final : public host::HostHandler {
 public:
  /// All must outlive this; they may be built after it.
  struct Receivers {
    const config::RingConfig& ring;
    NodeDriver& driver;
    host::HostServer& host;
    CpuSocket& cpu;
    Requests& requests;
    Observers& observers;
    PacketObservers& packet_observers;
    PromiseObservers& promise_observers;
  };
  explicit ClientCalls(const Receivers& receivers) : to_(receivers) {}

  void on_greeted(pid_t pid) override { to_.cpu.greeted(pid); }
  void on_left(pid_t pid) override { to_.cpu.left(pid); }
  std::optional<std::string> on_attach(const host::ClientInfo& client) override;
  void on_detach(const host::ClientInfo& client) override;
  void on_send(host::ClientId client, const client::SendRequest& request) override;
  void on_interrupt(host::ClientId client, const client::InterruptRequest& request) override;
  void on_pull(host::ClientId client, const client::PullRequest& request) override;
  void on_request(host::ClientId client, const client::JsonRequest& request) override;
  bool changes_something(const client::JsonRequest& request) const override;
  void on_observe(host::ClientId client, const client::ObserveRequest& request) override;
  void on_shortage(const std::string& why) override;
  void on_alive(host::ClientId client) override;
  void on_credit(host::ClientId client) override;

 private:
  void hear(const client::SendRequest& request);
  bool is_cpu(host::ClientId client) const { return to_.host.cpu() != nullptr && to_.host.cpu()->id == client; }

  Receivers to_;
};

/// What differs between a daemon and a node of a virtual ring, which shares its process with the others.
struct NodeBase {
  /// Null: the node makes its own, and holds the node as long as it lives.
  std::shared_ptr<NodeFolder> folder;
  /// Makes the driver of the node to which the folder belongs. The listener must not be called before it returns.
  std::function<std::unique_ptr<NodeDriver>(const NodeFolder&, DriverListener&)> make_driver;
  /// Starts the node anew, as if its power went off and on: a daemon its process.
  std::function<void()> start_anew;
  std::optional<cpu_set_t> cpu_cores;  ///< for the CPU's processes; empty: as this one
  host::TurnKeeper* turns = nullptr;   ///< of a virtual clock
  ClockControl* clock = nullptr;       ///< the same, as clients steer it
  /// Makes a filter through which all calls of clients pass; null: no filter.
  std::function<std::unique_ptr<host::HostHandler>(host::HostHandler& calls)> make_filter;
  /// The CPU's state, pid or boots have changed; may be empty.
  std::function<void(const CpuStatus&)> on_cpu_changed;
  std::chrono::nanoseconds cpu_boots_for{0};      ///< CpuOptions::boots_for
  std::function<void(int number)> on_cpu_signal;  ///< CpuOptions::on_signal
  std::string log_prefix;                         ///< of what is logged of this node alone
  int cpu_output = -1;  ///< descriptor for what the CPU's processes print; -1: as this process
};

/// One node of a ring, complete: builds its parts, hands each what it needs, starts and stops them. What clients call
/// for goes through ClientCalls to the controller; what comes out of the controller goes through EventRouter to
/// whoever it is for.
class Node {
 public:
  /// @throw std::exception if the node is held by another daemon, or a socket cannot be had
  Node(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& config,
       const NodeBase& base);

  void start();
  CpuStatus cpu_status() const { return cpu_.status(); }
  /// Ends everything cleanly; `done` is called from the event loop.
  void stop(std::function<void()> done);
  Faults& faults() { return faults_; }
  const Faults& faults() const { return faults_; }

  /// @name Faults of a node that shares its process with others
  ///@{
  /// As if the process were killed: clients lose their connections without a message, a child CPU dies, an attached
  /// one goes on. Afterwards this object may only be destroyed.
  void die();
  /// As if the process were stopped: clients that connect or ask have to wait. The caller stops the driver and its
  /// clock.
  void freeze() { host_.freeze(); }
  void thaw() { host_.thaw(); }
  ///@}

 private:
  /// No link is closed, its child CPU is killed, and the same program is started again.
  /// @throw std::system_error if it cannot be started
  void power_cycle();
  FolderWatch::Folder folder_to_watch();

  std::shared_ptr<NodeFolder> folder_;
  std::function<void()> start_anew_;
  std::unique_ptr<NodeDriver> driver_;
  EventRouter router_;
  ClientCalls calls_;
  std::unique_ptr<host::HostHandler> filter_;  ///< before them; null: none
  host::HostServer host_;
  Observers observers_;
  PacketObservers packet_observers_;
  PromiseObservers promise_observers_;
  CpuSocket cpu_;
  PinBoard pins_;
  Traffic traffic_;
  CpuSightings sightings_;
  NeighbourWatch neighbours_;
  SendReasons reasons_;
  DaemonInterrupts interrupts_;
  Faults faults_;
  std::optional<RingSupervisor> supervisor_;  ///< none if another node is the ring's supervisor
  RoundTrips round_trips_;
  LatelyDamaged lately_damaged_;
  Requests requests_;
  FolderWatch folder_watch_;
};

/// A node that is a process of its own, with links to its neighbours. Call this before the process pins itself to its
/// cores: its CPU, and the daemon that re_exec() starts in its place, get the cores that the process has now.
NodeBase daemon_base(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& node);

}  // namespace limb_ring::runtime
