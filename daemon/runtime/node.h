#pragma once

#include <sched.h>

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "config/ring_config.h"
#include "host/host_server.h"
#include "host/node_lock.h"
#include "runtime/boot_record.h"
#include "runtime/cpu_socket.h"
#include "runtime/engine.h"
#include "runtime/faults.h"
#include "runtime/folder_watch.h"
#include "runtime/change_notifier.h"
#include "runtime/observe_filter.h"
#include "runtime/observers.h"
#include "runtime/daemon_interrupts.h"
#include "runtime/packet_observers.h"
#include "runtime/pin_board.h"
#include "runtime/requests.h"
#include "runtime/ring_supervisor.h"
#include "runtime/round_trips.h"
#include "runtime/send_reason.h"
#include "runtime/traffic.h"

namespace limb_ring::runtime {

/// One node of a ring, complete: network controller and links (Engine), host port, CPU, pins.
/// What comes in at the host port goes to the controller; what comes out of the controller goes
/// to whoever asked for it.
class Node final : private EngineListener, private host::HostHandler {
 public:
  /// @throw std::exception where the node is held by another daemon, or a socket cannot be had
  Node(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& config);

  void start();
  /// Ends everything cleanly; `done` is called from the event loop.
  void stop(std::function<void()> done);
  /// Off and on again at once, as far as a process can: no goodbye to anybody, the CPU of its own killed, and
  /// the same program anew under the same pid. @throw std::system_error where that cannot be had
  [[noreturn]] void power_cycle();

  /// @name For requests and status
  ///@{
  const config::RingConfig& ring() const { return ring_; }
  const config::NodeConfig& config() const { return config_; }
  Engine& engine() { return engine_; }
  CpuSocket& cpu() { return cpu_; }
  PinBoard& pins() { return pins_; }
  Traffic& traffic() { return traffic_; }
  DaemonInterrupts& interrupts() { return interrupts_; }
  Faults& faults() { return faults_; }
  /// The configured one behind this.
  const config::NodeConfig& next() const;
  /// Nothing where another node is the ring's supervisor.
  const std::optional<RingSupervisor>& supervisor() const { return supervisor_; }
  /// When this node came to know of a broken line.
  core::Time broken_since() const { return broken_since_; }
  const RoundTrips& round_trips() const { return round_trips_; }
  const host::HostServer& host() const { return host_; }
  /// Why a send of this node ended so.
  SendReason why(const core::SendEnded& ended) const;
  ///@}

 private:
  void on_event(const core::Event& event) override;
  void on_round_end() override;
  void on_link(std::string_view what) override;

  void handle(const core::SendEnded& ended);
  void handle(const core::PinPulled& pin);
  void handle(const core::StateChanged& change);
  void handle(const core::PeerChanged& peer);
  void handle(const core::BeaconHome& beacon);

  std::optional<std::string> on_attach(const host::ClientInfo& client) override;
  void on_detach(const host::ClientInfo& client) override;
  void on_send(host::ClientId client, std::uint32_t token, std::uint8_t destination, std::uint8_t priority,
               std::uint8_t channel, wire::ByteView data) override;
  void on_interrupt(host::ClientId client, std::uint32_t token, std::uint8_t destination, std::uint8_t factor,
                    bool force) override;
  void on_pull(host::ClientId client, std::uint32_t token, std::uint8_t input) override;
  void on_request(host::ClientId client, std::uint32_t token, const std::string& json) override;
  void on_observe(host::ClientId client, const std::string& json) override;
  void on_alive(host::ClientId client) override;
  void on_credit(host::ClientId client) override;

  FolderWatch::Folder folder();
  void make_folder_again();
  void cpu_changed();
  void found(const Watchdog::Finding& finding);
  CpuSighting sighting_of(wire::NodeId node) const;
  watchdog::CpuKnown cpu_of(wire::NodeId node) const;

  const config::RingConfig& ring_;
  const config::NodeConfig& config_;
  std::optional<cpu_set_t> cores_;  ///< before the daemon pinned itself, where it does
  std::string directory_;
  std::optional<host::NodeLock> lock_;  ///< for a moment none: where the folder was removed
  std::optional<BootRecord> boots_;     ///< as lock_
  Engine engine_;
  host::HostServer host_;
  Observers observers_;
  ChangeNotifier change_notifier_;
  PacketObservers packet_observers_;
  CpuSocket cpu_;
  PinBoard pins_;
  Traffic traffic_;
  DaemonInterrupts interrupts_;
  Faults faults_;
  std::optional<RingSupervisor> supervisor_;
  RoundTrips round_trips_;
  core::Time broken_since_{};
  std::uint32_t cpu_boots_ = 0;
  FolderWatch folder_;
  Requests requests_;
};

}  // namespace limb_ring::runtime
