// Membership's part in a broken ring: what is left is an open chain, in which everything goes on and
// nothing is confirmed. (ours, protocol.md section 8)
#include "core/membership.h"
#include "core/mutation.h"

namespace limb_ring::core {

// An input that stays lost while the output leads on is a broken line, not a node left aside.
void Membership::watch_for_break(Time now) {
  const bool lost = input_ == Link::lost && output_ == Link::up;
  if (lost && break_due_ == kNever) break_due_ = now + settings_.break_grace;
}

// The node behind the break knows at once; after a grace for the bypass it announces it. (ours)
void Membership::own_input_broken(Time now) {
  break_due_ = kNever;
  break_known_ = true;
  break_before_ = input_from_;
  break_behind_ = settings_.id;
  enter_open_chain(now);
}

// Only the node behind a break is believed: echoes of its word would outlive the break.
void Membership::hear_break(const wire::Beacon& beacon, Time now) {
  if (break_known_ && break_behind_ == settings_.id) return;
  break_known_ = true;
  break_before_ = beacon.break_before;
  break_behind_ = beacon.break_behind;
  enter_open_chain(now);
}

// A node that has not joined says its hello first, also into an open chain. The chain's last node,
// whose output may be gone, is in it too.
void Membership::enter_open_chain(Time now) {
  drained_at_ = kNever;
  const bool joined_before = accepts_sends();
  if (state_ == NodeState::open_chain || state_ == NodeState::doubled_id) return;
  if (!joined_before && output_ != Link::up) return;
  enter(NodeState::open_chain, now);
  transmit_.set_open_chain(true, now);
  if (hello_out_) return;
  if (!joined_before) return say_hello(now);
  transmit_.set_gate(Gate::open);
  change(now);
}

void Membership::leave_open_chain(Time now) {
  drained_at_ = kNever;
  if (broken(Mutation::never_heals)) return;
  break_known_ = false;
  transmit_.set_open_chain(false, now);
  renumber(now);
  enter(ring_size_ == 1 ? NodeState::alone : NodeState::up, now);
}

}  // namespace limb_ring::core
