#include "runtime/orders.h"

#include "limb_ring/host_port.h"
#include "runtime/owners.h"

namespace limb_ring::runtime {

void Orders::interrupt(wire::NodeId to, std::uint8_t factor, Ended done) {
  const std::uint32_t token = ++last_token_;
  interrupts_.emplace(token, std::move(done));
  engine_.controller().interrupt({kOrdersOwner, token, to, factor}, engine_.now());
  engine_.pump();
}

void Orders::on_ended(const core::SendEnded& ended) {
  const auto it = interrupts_.find(ended.token);
  if (it == interrupts_.end()) return;
  const Ended done = std::move(it->second);
  interrupts_.erase(it);
  done(ended);
}

void Orders::reset(wire::NodeId node, std::uint8_t factor, std::chrono::milliseconds timeout, ResetDone done) {
  Reset& reset = resets_.emplace_back(io_, node, std::move(done));
  reset.begun = engine_.now();
  reset.before = cpu_of_(node);
  reset.report.boots = reset.before.boots;
  reset.deadline.expires_after(timeout);
  reset.deadline.async_wait([this, which = &reset](const boost::system::error_code& error) {
    if (error) return;
    const auto place = place_of(which);
    finish(place, false,
           place->taken ? "the reset pin was pulled, but no CPU has come back in time"
                        : "the interrupt has not come home in time");
  });
  interrupt(node, factor, [this, which = &reset](const core::SendEnded& ended) { reset_ended(which, ended); });
}

void Orders::reset_ended(Reset* reset, const core::SendEnded& ended) {
  const auto place = place_of(reset);
  if (place == resets_.end()) return;
  place->taken = ended.outcome == core::Outcome::delivered;
  place->report.round_trip = ended.round_trip;
  if (!place->taken) {
    std::string why = std::string("the interrupt was ") + to_string(static_cast<Outcome>(ended.outcome));
    if (ended.reject != core::Reject::none) why += std::string(": ") + core::to_string(ended.reject);
    return finish(place, false, why);
  }
  if (!place->before.comes_back && place->before.absent)
    return finish(place, false, "the reset pin was pulled, but no CPU is attached to that node: nothing to reset");
  if (!place->before.comes_back)
    return finish(place, false, "the CPU was killed, but nobody restarts it: it did not declare that its owner does");
  on_cpu_changed(place->node);
}

void Orders::on_cpu_changed(wire::NodeId node) {
  for (auto it = resets_.begin(); it != resets_.end();) {
    const auto place = it++;
    if (place->node != node || !place->taken) continue;
    place->report.boots = cpu_of_(node).boots;
    if (place->report.boots > place->before.boots) finish(place, true, "the CPU has booted again");
  }
}

Orders::ResetPlace Orders::place_of(const Reset* reset) {
  auto it = resets_.begin();
  while (it != resets_.end() && &*it != reset) ++it;
  return it;
}

void Orders::finish(ResetPlace place, bool success, const std::string& message) {
  if (place == resets_.end()) return;
  ResetReport report = place->report;
  const ResetDone done = std::move(place->done);
  report.success = success;
  report.message = message;
  report.confirmed = std::chrono::duration_cast<std::chrono::milliseconds>(engine_.now() - place->begun);
  resets_.erase(place);
  done(report);
}

void Orders::stop() {
  interrupts_.clear();
  resets_.clear();
}

}  // namespace limb_ring::runtime
