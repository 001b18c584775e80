#include "runtime/daemon_interrupts.h"

#include "runtime/send_owner.h"

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
  Reset& reset = resets_.emplace_back(node, cpus_.known(node), driver_.now(), std::move(done));
  reset.deadline =
      driver_.clock().timer([this, which = &reset] { finish(place_of(which), which->order.timed_out(driver_.now())); });
  reset.deadline->expires_at(driver_.clock().now() + timeout);
  interrupt(node, factor, [this, which = &reset](const core::SendEnded& ended) {
    const auto place = place_of(which);
    if (place != resets_.end())
      finish(place, place->order.interrupt_ended(ended, cpus_.known(place->node), driver_.now()));
  });
}

void DaemonInterrupts::on_cpu_changed(wire::NodeId node) {
  for (auto it = resets_.begin(); it != resets_.end();) {
    const auto place = it++;
    if (place->node == node) finish(place, place->order.cpu_changed(cpus_.known(node), driver_.now()));
  }
}

DaemonInterrupts::ResetPlace DaemonInterrupts::place_of(const Reset* reset) {
  auto it = resets_.begin();
  while (it != resets_.end() && &*it != reset) ++it;
  return it;
}

void DaemonInterrupts::finish(ResetPlace place, const watchdog::ResetOrder::Report& report) {
  if (!report) return;
  const ResetDone done = std::move(place->done);
  resets_.erase(place);
  done(*report);
}

void DaemonInterrupts::stop() {
  interrupts_.clear();
  resets_.clear();
}

}  // namespace limb_ring::runtime
