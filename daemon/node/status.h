#pragma once

#include <optional>

#include "config/node_row.h"
#include "config/ring_config.h"
#include "node/cpu_socket.h"
#include "node/event_router.h"
#include "node/faults.h"
#include "node/host_server.h"
#include "node/neighbour_watch.h"
#include "node/node_driver.h"
#include "node/pin_board.h"

namespace limb_ring::runtime {

/// Whose state a status row shows.
struct StatusSources {
  const config::RingConfig& ring;
  const config::NodeConfig& node;
  const NodeDriver& driver;
  const CpuSocket& cpu;
  const host::HostServer& host;
  Faults& faults;
  const RoundTrips& round_trips;
  const LatelyDamaged& lately_damaged;
  const NeighbourWatch& neighbours;
  const std::optional<RingSupervisor>& supervisor;  ///< none if another node is the ring's supervisor
  const host::TurnKeeper* turns;                    ///< null: the ring's clock is the machine's
};

/// A node's row of `ringctl status --json`.
status::NodeRow status_row(const StatusSources& from, bool with_heard);

}  // namespace limb_ring::runtime
