#include "node/cpu_sightings.h"

namespace limb_ring::runtime {

watchdog::CpuSighting CpuSightings::of(wire::NodeId node) const {
  if (node == self_.id) {
    const CpuStatus status = own_.status();
    return {driver_.now(), status.boots, status.state, status.silent,
            status.kind != CpuKind::attached || status.restarted_by_owner};
  }
  return watchdog::sighting_of(driver_.controller().membership().peers()[node]);
}

watchdog::CpuKnown CpuSightings::known(wire::NodeId node) const {
  const watchdog::CpuSighting cpu = of(node);
  const core::NetworkController& controller = driver_.controller();
  return watchdog::known_of(cpu, watchdog::is_heard(cpu, driver_.now(), ring_.timeouts.beacon),
                            watchdog::reach_of(controller.settings().order, controller.membership().broken_line(),
                                               wire::NodeId{self_.id}, node));
}

}  // namespace limb_ring::runtime
