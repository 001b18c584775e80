#include "node/pin_board.h"

#include <spdlog/spdlog.h>

#include "node/session.h"

namespace limb_ring::runtime {

void PinBoard::latch(std::uint8_t source, std::int64_t clock_ns) {
  latch_ = {latch_.count + 1, wire::NodeId{source}, static_cast<std::uint64_t>(clock_ns)};
  cpu_.clock_latched(latch_);
}

std::string PinBoard::pull(std::uint8_t factor, std::uint8_t source, std::int64_t clock_ns) {
  using Action = config::PinConfig::Action;
  using Interrupt = limb_ring::Interrupt;
  const config::PinConfig& pin = pins_[factor];
  const std::string by = "INT" + std::to_string(factor) + " from node " + std::to_string(source);
  switch (pin.action) {
    case Action::none:
      return by + ": wired to nothing";
    case Action::reset:
      return by + ": reset: " + cpu_.reset(by).message;
    case Action::stop:
      cpu_.interrupt(Interrupt::Action::stop, source, factor);
      return by + ": stop";
    case Action::notify:
      cpu_.interrupt(Interrupt::Action::notify, source, factor);
      return by + ": notify";
    case Action::signal:
      return by + ": signal: " + cpu_.signal(pin.signal).message;
    case Action::exec:
      return by + ": exec: " + cpu_.run(pin.command).message;
    case Action::sync:
      latch(source, clock_ns);
      return by + ": clock latched";
  }
  return by;
}

namespace {

constexpr core::Owner kInterruptsOwner = SendOwner::of(SendOwner::Kind::daemon_interrupts).to_core();

}  // namespace

void DaemonInterrupts::interrupt(wire::NodeId to, std::uint8_t factor, Ended done) {
  const std::uint32_t token = ++last_token_;
  interrupts_.emplace(token, std::move(done));
  driver_.controller().apply(core::input::Interrupt{{kInterruptsOwner, token, to, wire::Factor{factor}}},
                             driver_.now());
  driver_.pump();
}

void DaemonInterrupts::on_ended(const core::SendEnded& ended) {
  const auto it = interrupts_.find(ended.token);
  if (it == interrupts_.end()) return;
  const Ended done = std::move(it->second);
  interrupts_.erase(it);
  done(ended);
}

void DaemonInterrupts::reset(wire::NodeId node, std::uint8_t factor, std::chrono::milliseconds timeout,
                             ResetDone done) {
  const std::uint32_t number = ++last_reset_;
  auto deadline = driver_.clock().timer([this, number] {
    const auto place = resets_.find(number);
    finish(place, place->second.order.timed_out(driver_.now()));
  });
  deadline->expires_at(driver_.clock().now() + timeout);
  Reset& reset = resets_.try_emplace(number, node, cpus_.known(node), driver_.now(), std::move(done)).first->second;
  reset.deadline = std::move(deadline);
  interrupt(node, factor, [this, number](const core::SendEnded& ended) {
    const auto place = resets_.find(number);
    if (place == resets_.end()) return;
    Reset& of = place->second;
    finish(place, of.order.interrupt_ended(ended, cpus_.known(of.node), driver_.now()));
  });
}

void DaemonInterrupts::on_cpu_changed(wire::NodeId node) {
  for (auto it = resets_.begin(); it != resets_.end();) {
    const auto place = it++;
    Reset& reset = place->second;
    if (reset.node == node) finish(place, reset.order.cpu_changed(cpus_.known(node), driver_.now()));
  }
}

void DaemonInterrupts::finish(Resets::iterator place, const watchdog::ResetOrder::Report& report) {
  if (!report) return;
  const ResetDone done = std::move(place->second.done);
  resets_.erase(place);
  done(*report);
}

void DaemonInterrupts::stop() {
  interrupts_.clear();
  resets_.clear();
}

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
