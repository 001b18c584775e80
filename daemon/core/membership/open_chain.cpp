// Membership's part in a broken ring: what is left is an open chain, in which everything goes on and
// nothing is confirmed. (ours, protocol.md section 8.4)
#include "core/membership/membership.h"
#include "core/mutation.h"

namespace limb_ring::core {

// The input stays lost while the output is up: a broken line, and not that this node was bypassed.
void Membership::watch_for_break(Time now) {
  const bool lost = (input_ == Link::lost || input_folded_) && output_ == Link::up && !(input_folded_ && own_break());
  if (lost && break_due_ == kNever) break_due_ = now + settings_.break_grace;
}

// The node behind the break knows at once; after a grace for the bypass it announces it. (ours, protocol.md
// section 8.3)
void Membership::own_input_broken(Time now) {
  break_due_ = kNever;
  break_known_ = true;
  break_before_ = input_from_;
  break_behind_ = settings_.id;
  if (!input_folded_) return enter_open_chain(now);
  change(now);
}

// Only the node behind a break is believed: the beacons of others would repeat it after the break is mended.
void Membership::hear_break(const wire::Beacon& beacon, Time now) {
  if (own_break()) return;
  break_known_ = true;
  break_before_ = beacon.break_before;
  break_behind_ = beacon.break_behind;
  if (beacon.input != wire::LinkState::folded) enter_open_chain(now);
}

// A node that has not joined says its hello first, also into an open chain. The last node of the chain belongs to it
// too, though its output may be gone.
void Membership::enter_open_chain(Time now) {
  drained_at_ = kNever;
  const bool joined_before = accepts_sends();
  if (state_ == NodeState::open_chain || state_ == NodeState::doubled_id) return;
  if (!joined_before && output_ != Link::up) return;
  enter(NodeState::open_chain, now);
  transmit_.set_open_chain(true, now);
  if (hello_out_) return;
  if (!joined_before) return say_hello(now);
  transmit_.set_gate(Gate::open, now);
  change(now);
}

void Membership::leave_open_chain(Time now) {
  drained_at_ = kNever;
  if (broken(Mutation::never_heals)) return;
  break_known_ = input_folded_;
  transmit_.set_open_chain(false, now);
  renumber(now);
  enter(settled_state(), now);
}

// ---- fold-back ------------------------------------------------------------------------------

// A fold closes the ring again, so sends are still confirmed. The broken line is announced nevertheless.
void Membership::set_folded(bool input, bool output, Time now) {
  if (input == input_folded_ && output == output_folded_) return;
  if (input_folded_ && !input && own_break()) break_known_ = false;
  if (input_folded_ && !input) break_due_ = kNever;
  input_folded_ = input;
  output_folded_ = output;
  watch_for_break(now);
  look_for_folds(now);
  if (accepts_sends()) change(now);
}

NodeState Membership::settled_state() const {
  if (ring_size_ == 1) return NodeState::alone;
  return folded_ ? NodeState::folded : NodeState::up;
}

bool Membership::says_folded(const Peer& peer, Time now) const {
  constexpr int kMissed = 5;  // beacons missed: the node is gone, or beyond a second break
  if (!peer.beacon_heard || now - peer.heard_at > kMissed * settings_.beacon) return false;
  return peer.beacon.input == wire::LinkState::folded || peer.beacon.output == wire::LinkState::folded;
}

void Membership::look_for_folds(Time now) {
  if (!settings_.fold_back) return;
  folded_ = input_folded_ || output_folded_;
  for (const NodeId node : settings_.order) folded_ = folded_ || says_folded(peers_[node], now);
  if (folded_) fold_over_ = now + settings_.beacon + settings_.send_timeout();
  if (!folded_ && state_ != NodeState::open_chain) break_known_ = break_known_ && own_break();
  if (settled()) enter(settled_state(), now);
}

}  // namespace limb_ring::core
