#pragma once

#include <sched.h>

#include <boost/asio/io_context.hpp>
#include <functional>
#include <optional>

#include "config/ring_config.h"
#include "host/host_server.h"
#include "runtime/client_calls.h"
#include "runtime/cpu_sightings.h"
#include "runtime/cpu_socket.h"
#include "runtime/daemon_interrupts.h"
#include "runtime/engine.h"
#include "runtime/event_router.h"
#include "runtime/faults.h"
#include "runtime/folder_watch.h"
#include "runtime/node_folder.h"
#include "runtime/observers.h"
#include "runtime/packet_observers.h"
#include "runtime/pin_board.h"
#include "runtime/requests.h"
#include "runtime/ring_supervisor.h"
#include "runtime/round_trips.h"
#include "runtime/send_reason.h"
#include "runtime/traffic.h"

namespace limb_ring::runtime {

/// One node of a ring, complete: builds its parts, hands each what it needs, starts and stops them. What clients call
/// for goes through ClientCalls to the controller; what comes out of the controller goes through EventRouter to
/// whoever it is for.
class Node {
 public:
  /// @throw std::exception where the node is held by another daemon, or a socket cannot be had
  Node(boost::asio::io_context& io, const config::RingConfig& ring, const config::NodeConfig& config);

  void start();
  /// Ends everything cleanly; `done` is called from the event loop.
  void stop(std::function<void()> done);

 private:
  /// As if its power went off and on: no link is closed, its child CPU is killed, and the same program is started again
  /// under the same pid. @throw std::system_error where it cannot be started
  [[noreturn]] void power_cycle();
  FolderWatch::Folder folder_to_watch();

  std::optional<cpu_set_t> cores_;  ///< before the daemon pinned itself, where it does
  NodeFolder folder_;
  EventRouter router_;
  ClientCalls calls_;
  Engine engine_;
  host::HostServer host_;
  Observers observers_;
  PacketObservers packet_observers_;
  CpuSocket cpu_;
  PinBoard pins_;
  Traffic traffic_;
  CpuSightings sightings_;
  SendReasons reasons_;
  DaemonInterrupts interrupts_;
  Faults faults_;
  std::optional<RingSupervisor> supervisor_;  ///< none where another node is the ring's supervisor
  RoundTrips round_trips_;
  Requests requests_;
  FolderWatch folder_watch_;
};

}  // namespace limb_ring::runtime
