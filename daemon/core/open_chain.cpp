// Membership's part in a broken ring: what is left is an open chain, in which everything goes on and
// nothing is confirmed. (ours, protocol.md section 8)
#include "core/membership.h"

namespace limb_ring::core {

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

void Membership::enter_open_chain(Time now) {
  drained_at_ = kNever;
  if (state_ == NodeState::open_chain || output_ != Link::up || state_ == NodeState::doubled_id) return;
  enter(NodeState::open_chain, now);
  transmit_.set_open_chain(true, now);
  if (!hello_out_) transmit_.set_gate(Gate::open);
  change(now);
}

void Membership::leave_open_chain(Time now) {
  drained_at_ = kNever;
  break_known_ = false;
  transmit_.set_open_chain(false, now);
  renumber(now);
  enter(ring_size_ == 1 ? NodeState::alone : NodeState::up, now);
}

}  // namespace limb_ring::core
