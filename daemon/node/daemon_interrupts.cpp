#include "node/daemon_interrupts.h"

#include "node/send_owner.h"

namespace limb_ring::runtime {
namespace {

constexpr core::Owner kInterruptsOwner = SendOwner::of(SendOwner::Kind::daemon_interrupts).to_core();

}  // namespace

void DaemonInterrupts::interrupt(wire::NodeId to, std::uint8_t factor, Ended done) {
  const std::uint32_t token = ++last_token_;
  interrupts_.emplace(token, std::move(done));
  driver_.controller().interrupt({kInterruptsOwner, token, to, wire::Factor{factor}}, driver_.now());
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

}  // namespace limb_ring::runtime
