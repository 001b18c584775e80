#pragma once

#include "config/watchdog.h"
#include "node/cpu_socket.h"
#include "node/daemon_interrupts.h"
#include "node/faults.h"
#include "node/host_server.h"
#include "node/lately_damaged.h"
#include "node/neighbour_watch.h"
#include "node/node_driver.h"
#include "node/node_folder.h"
#include "node/observers.h"
#include "node/pin_board.h"
#include "node/round_trips.h"
#include "node/send_reason.h"
#include "node/traffic.h"

namespace limb_ring::runtime {

/// The one place that knows where events of a node go: what comes out of its network controller, what becomes of its
/// CPU, and what its watchdog finds.
class EventRouter final : public DriverListener {
 public:
  /// All must outlive the router; they may be built after it.
  struct Receivers {
    const config::NodeConfig& node;
    std::string log_prefix;
    const SendReasons& reasons;
    NodeDriver& driver;
    host::HostServer& host;
    NodeFolder& folder;
    CpuSocket& cpu;
    PinBoard& pins;
    Traffic& traffic;
    DaemonInterrupts& interrupts;
    Faults& faults;
    RoundTrips& round_trips;
    Observers& observers;
    LatelyDamaged& lately_damaged;
    NeighbourWatch& neighbours;
  };
  explicit EventRouter(const Receivers& receivers) : to_(receivers) {}

  void on_event(const core::Event& event) override;
  void on_round_end() override;
  void on_link(std::string_view what) override;

  /// Something that status shows of the own CPU has changed.
  void on_cpu_changed();
  /// Pin `factor` of this node was pulled, by an INTP, or here for what is asked of all nodes; `clock_ns`: when.
  void pull(std::uint8_t factor, std::uint8_t source, std::int64_t clock_ns);
  void on_finding(const watchdog::Watchdog::Finding& finding);

 private:
  void handle(const core::SendEnded& ended);
  void handle(const core::PinPulled& pin);
  void handle(const core::StateChanged& change);
  void handle(const core::PeerChanged& peer) { to_.interrupts.on_cpu_changed(peer.node); }
  void handle(const core::BeaconHome& beacon) { to_.round_trips.add(to_.driver.now(), beacon.round_trip); }
  void tell_client(host::ClientId client, const core::SendEnded& ended);
  void look_at_neighbours();

  Receivers to_;
  std::uint32_t cpu_boots_ = 0;
};

}  // namespace limb_ring::runtime
