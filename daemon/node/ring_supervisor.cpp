#include "node/ring_supervisor.h"

#include <spdlog/spdlog.h>

namespace limb_ring::runtime {

RingSupervisor::RingSupervisor(const config::RingConfig& ring, NodeDriver& driver, DaemonInterrupts& interrupts,
                               const CpuSightings& cpus, Found found)
    : ring_(ring),
      driver_(driver),
      interrupts_(interrupts),
      cpus_(cpus),
      found_(std::move(found)),
      watchdog_(ring.supervisor, wire::kMissedBeacons * ring.timeouts.beacon, watchdog::watched_in(ring)),
      timer_(driver.clock().timer([this] {
        poll();
        poll_later();
      })) {}

void RingSupervisor::start() {
  const auto watched = watchdog_.watched().size();
  if (watched == 0 || watchdog_.policy() == Watchdog::Policy::off) return;
  spdlog::info("supervisor of {} CPUs, policy {}", watched, watchdog::to_string(watchdog_.policy()));
  poll_later();
}

// Polled by the clock and not by the beacons, so that a daemon that was not scheduled reads all waiting beacons first.
void RingSupervisor::poll_later() { timer_->expires_at(driver_.clock().now() + ring_.timeouts.beacon); }

void RingSupervisor::poll() {
  const Watchdog::Round round = watchdog_.evaluate([this](wire::NodeId node) { return cpus_.of(node); }, driver_.now());
  for (const Watchdog::Finding& finding : round.findings) tell(finding);
  for (const wire::NodeId node : round.resets) reset(node);
}

void RingSupervisor::reset(wire::NodeId node) {
  const std::uint8_t factor =
      *config::first_pin(*ring_.find(node), config::PinConfig::Action::reset);  // check_ring() has seen to it
  interrupts_.reset(node, factor, watchdog_.confirm_within(), [this, node](const watchdog::ResetReport& report) {
    const auto failure = watchdog_.reset_ended(node, report.success(), report.message, driver_.now());
    if (failure) tell(*failure);
  });
}

void RingSupervisor::tell(const Watchdog::Finding& finding) const {
  const bool bad = finding.verdict == CpuVerdict::hung || finding.verdict == CpuVerdict::unreachable;
  spdlog::log(bad ? spdlog::level::warn : spdlog::level::info, "CPU of node {} ({}) {}: {}", unsigned{finding.node},
              ring_.find(finding.node)->name, to_string(finding.verdict), finding.what);
  found_(finding);
}

}  // namespace limb_ring::runtime
