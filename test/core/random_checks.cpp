// What a random run checks afterwards: every promise of the ring.
#include "core/random_run.h"

namespace limb_ring::core {
namespace {

bool may_have_arrived(Outcome outcome) {
  return outcome == Outcome::lost || outcome == Outcome::unconfirmed || outcome == Outcome::cancelled;
}

}  // namespace

void RandomRun::check_ends() {
  for (std::uint32_t serial = 0; serial < sent_.size(); ++serial) check_send(serial, sent_[serial]);
}

void RandomRun::check_send(std::uint32_t serial, const Sent& sent) {
  const std::string name = "packet " + std::to_string(serial);
  if (!sent.ended) {
    if (sent.source_life == lives_[sent.source]) complain(name + " never ended");
    return;
  }
  const Outcome outcome = sent.end.outcome;
  const bool broadcast = sent.destination == wire::kBroadcast;
  for (const auto& receipt : sent.receipts)
    if (!broadcast && receipt.first.first != sent.destination) complain(name + " arrived elsewhere");
  if (outcome == Outcome::delivered && sent.receipts.empty()) complain(name + " delivered, yet nobody has it");
  const bool may_be_there = outcome == Outcome::delivered || may_have_arrived(outcome) ||
                            (broadcast && outcome == Outcome::refused);
  if (!may_be_there && !sent.receipts.empty())
    complain(name + " ended " + std::to_string(static_cast<int>(outcome)) + ", yet it arrived");
}

// INTPs carry no serial number, so they are counted: by source, destination and factor.
void RandomRun::check_interrupts() {
  std::map<std::array<unsigned, 3>, Bounds> bounds;
  for (const auto& [key, sent] : interrupts_) {
    if (!sent.ended && sent.source_life == lives_[sent.source]) complain("an interrupt never ended");
    for (unsigned node = 0; node < nodes_; ++node) add_bounds(sent, node, bounds[{sent.source, node, sent.factor}]);
  }
  for (const auto& [key, pulled] : pulls_)
    if (pulled > bounds[key].most) complain("a pin pulled more often than asked for");
  for (const auto& [key, bound] : bounds)
    if (pulls_[key] < bound.least) complain("an interrupt was delivered, yet its pin was not pulled");
}

// A node that was bypassed or restarted has forgotten what it took, so a retry pulls again.
void RandomRun::add_bounds(const Interrupt& sent, unsigned node, Bounds& bounds) const {
  const bool broadcast = sent.destination == wire::kBroadcast;
  if (broadcast ? node == sent.source : node != sent.destination) return;
  const bool sure = sent.ended && sent.end.outcome == Outcome::delivered;
  const bool maybe = !sent.ended || sure || may_have_arrived(sent.end.outcome) ||
                     (broadcast && sent.end.outcome == Outcome::refused);
  if (sure && !broadcast) ++bounds.least;
  if (maybe) bounds.most += was_away_[node] ? 4 : 1;
}

// Traffic has long ended: whatever is no beacon has a life without end.
void RandomRun::check_silence() {
  slices_when_quiet_ = 0;
  ring_->run_for(20ms);
  if (slices_when_quiet_ != 0) complain("something still circulates: " + std::to_string(slices_when_quiet_));
}

}  // namespace limb_ring::core
