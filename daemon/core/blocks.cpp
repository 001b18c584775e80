#include "core/blocks.h"

#include <algorithm>

namespace limb_ring::core {

Blocks::Blocks(const Settings& settings)
    : settings_(settings),
      receive_(settings_, memory_, membership_, counters_),
      packet_manager_(settings_, transmit_, counters_, line_),
      transmit_(settings_, counters_, events_),
      relay_(settings_, packet_manager_, receive_, pins_, returns_, counters_),
      pins_(settings_, memory_, membership_, counters_, events_),
      returns_(settings_, transmit_, membership_, receive_, pins_, counters_),
      membership_(settings_, transmit_, memory_, counters_, events_),
      memory_(settings_.send_timeout(), settings_.falls_into_parts()) {}

// ---- the lines ----------------------------------------------------------------------------

void Blocks::input_up(NodeId from, Time now, bool folded) {
  input_gap(now);
  membership_.input_up(from, folded, now);
}

// A beacon that follows from a packet that is broken off tells of the loss already.
void Blocks::input_lost(Time now) {
  own_changes();
  relay_.input_gap(now);
  membership_.input_lost(now);
  settle(now);
}

void Blocks::output_up(NodeId to, Time now, bool folded) {
  own_changes();
  output_replaced(now);
  relay_.set_successor(to);
  membership_.output_up(to, folded, now);
}

void Blocks::output_lost(Time now) {
  own_changes();
  packet_manager_.output_lost();
  membership_.output_lost(now);
}

void Blocks::output_replaced(Time now) {
  packet_manager_.output_lost();
  packet_manager_.output_up(now);
}

void Blocks::set_neighbours(NodeId before, NodeId next, NodeId successor) {
  relay_.set_successor(successor);
  membership_.set_neighbours(before, next);
}

void Blocks::receive(Line on, const wire::Slice& slice, Time now) {
  if (tap_ != nullptr) tap_->arrives(slice, on, now);
  const Relay::Effect effect = relay_.receive(slice, now);
  if (effect.own) own_changes();
  if (effect.on_line && settled_) return;  // the usual case on a line without a data rate
  // If the line takes time, everything that comes in at one instant competes for it;
  // where it takes none, what can go goes at once, so that a batch never fills the buffer.
  settings_.byte_time_out.count() == 0 ? run(now) : settle(now);
}

void Blocks::cpu_reset(Owner cpu, Time now) {
  own_changes();
  transmit_.cancel(cpu, now);
  receive_.flush();
}

// ---- time ---------------------------------------------------------------------------------

void Blocks::handle_timeout(Time now) {
  if (relay_.deadline() <= now) {
    own_changes();
    relay_.handle_timeout(now);
  }
  if (own_deadline(now) > now) return;
  own_changes();
  transmit_.handle_timeout(now);
  membership_.handle_timeout(now);
}

void Blocks::run(Time now) {
  settle(now);
  put_onto_line(now);
  settle(now);  // a send into an open chain ends as it leaves, and may use up the sequence numbers
}

void Blocks::settle_changes(Time now) {
  settled_ = true;
  if (membership_.settle(now)) own_changes();
}

Time Blocks::next_deadline(Time now) const {
  return std::min(std::min(relay_.deadline(), packet_manager_.deadline()), own_deadline(now));
}

Time Blocks::find_own_deadline(Time now) const {
  // A packet that the CPU does not read is not a reason to wake up.
  const Time received = receive_.is_due(now) ? kNever : receive_.next();
  const Time node = std::min(transmit_.deadline(), membership_.deadline());
  return std::min(node, std::min(events_.next(), received));
}

}  // namespace limb_ring::core
