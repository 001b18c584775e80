#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "config/ring_config.h"
#include "host/host_server.h"
#include "runtime/cpu_socket.h"
#include "runtime/faults.h"
#include "runtime/lately_damaged.h"
#include "runtime/node_driver.h"
#include "runtime/ring_supervisor.h"
#include "runtime/round_trips.h"

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
  const std::optional<RingSupervisor>& supervisor;  ///< none where another node is the ring's supervisor
};

/// A node's row of `ringctl status --json`, as docs/reference/requests.md describes it.
nlohmann::json status_row(const StatusSources& from);

/// A latch of a node's clock, as the request `latch` answers.
nlohmann::json latch_json(const wire::ClockLatch& latch);

}  // namespace limb_ring::runtime
