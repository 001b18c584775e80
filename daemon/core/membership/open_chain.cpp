// Membership's part in a broken ring. What is left of the ring is an open chain: everything goes on, nothing is
// confirmed. A fold closes the ring again. (ours, protocol.md sections 8.3, 8.4 and 8.12)
#include "core/membership/membership.h"

namespace limb_ring::core {

// ---- broken lines ---------------------------------------------------------------------------

// An input that stays lost while the output is up is a broken line: a node that is bypassed loses both.
void Membership::watch_for_break(Time now) {
  if (input_.folded && break_.is_own()) return;
  const bool lost = input_.state == wire::LinkState::silent || input_.folded;
  if (lost && output_.up() && !timers_.runs(Timer::own_break))
    timers_.start(Timer::own_break, now + settings_.break_grace);
}

// The node behind a break sees the loss at once. It announces the break only after break_grace, since a bypass may mend
// it. (ours, protocol.md section 8.3)
void Membership::own_input_broken(Time now) {
  timers_.stop(Timer::own_break);
  break_.found(input_.neighbour);
  if (input_.folded)
    beacon_changed(now);
  else
    break_known(now);
}

// The last node of the chain belongs to it even if its output is gone. But a node that has not joined yet needs one.
void Membership::break_known(Time now) {
  if (accepts_sends() || output_.up()) on(Input::break_known, now);
}

// ---- open chain -----------------------------------------------------------------------------

void Membership::go_on_unconfirmed(Time now) {
  transmit_.set_open_chain(true, now);
  if (hello_.out) return;
  if (hello_under_way()) return say_hello(now);
  transmit_.set_gate(Gate::open, now);
  beacon_changed(now);
}

// A node that has not joined says its hello first, also into an open chain.
void Membership::say_hello_into_chain(Time now) {
  transmit_.set_open_chain(true, now);
  if (!hello_.out) say_hello(now);
}

void Membership::start_drain(Time now) {
  timers_.start(Timer::drained, std::min(timers_[Timer::drained], now + settings_.send_timeout()));
}

void Membership::confirm_again(Time now) {
  timers_.stop(Timer::drained);
  break_.ring_closed(input_.folded);
  transmit_.set_open_chain(false, now);
  renumber(now);
}

// ---- folds ----------------------------------------------------------------------------------

// A fold closes the ring again, so sends are still confirmed. The broken line is announced nevertheless.
void Membership::set_folded(bool input, bool output, Time now) {
  if (input == input_.folded && output == output_.folded) return;
  if (input_.folded && !input) {
    break_.own_mended();
    timers_.stop(Timer::own_break);
  }
  input_.folded = input;
  output_.folded = output;
  watch_for_break(now);
  look_for_folds(now);
  if (accepts_sends()) beacon_changed(now);
}

bool Membership::says_folded(const Peer& peer, Time now) const {
  if (!peer.beacon_heard || now - peer.beacon_at > wire::kMissedBeacons * settings_.beacon) return false;
  return peer.beacon.input == wire::LinkState::folded || peer.beacon.output == wire::LinkState::folded;
}

void Membership::look_for_folds(Time now) {
  if (!settings_.fold_back) return;
  fold_.known = input_.folded || output_.folded;
  for (const NodeId node : settings_.order) fold_.known = fold_.known || says_folded(peers_[node], now);
  if (fold_.known) fold_.over = now + settings_.beacon + settings_.send_timeout();
  if (!fold_.known && state_ != NodeState::open_chain) break_.keep_own_alone();
  update_closed_state(now);
}

}  // namespace limb_ring::core
