#include "runtime/cpu_sightings.h"

namespace limb_ring::runtime {

watchdog::CpuSighting CpuSightings::of(wire::NodeId node) const {
  if (node == self_.id) {
    const CpuStatus status = own_.status();
    return {engine_.now(), status.boots, status.state, status.silent,
            status.kind != CpuKind::attached || status.restarted_by_owner};
  }
  const core::Peer& peer = engine_.controller().membership().peers()[node];
  const wire::Beacon& beacon = peer.beacon;
  return {peer.beacon_heard ? std::make_optional(peer.heard_at) : std::nullopt, beacon.cpu_boots, beacon.cpu_state,
          std::chrono::milliseconds(beacon.cpu_silent_ms), beacon.cpu_comes_back};
}

watchdog::CpuKnown CpuSightings::known(wire::NodeId node) const {
  const watchdog::CpuSighting cpu = of(node);
  const core::NetworkController& controller = engine_.controller();
  const bool heard = cpu.heard_at && engine_.now() - *cpu.heard_at < watchdog::kMissedBeacons * ring_.timeouts.beacon;
  return {cpu.boots, cpu.comes_back, cpu.state == wire::CpuState::absent, heard,
          watchdog::reach_of(controller.settings().order, controller.membership().broken_line(), self_.id, node)};
}

}  // namespace limb_ring::runtime
