#include "core/blocks.h"

#include <algorithm>

namespace limb_ring::core {

Blocks::Blocks(const Settings& settings)
    : settings_(settings),
      transmit_(settings_, counters_, events_),
      memory_(settings_.send_timeout(), settings_.fold_back),
      membership_(settings_, transmit_, memory_, counters_, events_),
      receive_(settings_, memory_, membership_, counters_),
      pins_(settings_, memory_, membership_, counters_, events_),
      packet_manager_(settings_, transmit_, counters_, line_),
      returns_(settings_, transmit_, membership_, receive_, pins_, counters_),
      relay_(settings_, packet_manager_, receive_, pins_, returns_, counters_) {}

// ---- the lines ----------------------------------------------------------------------------

void Blocks::input_up(NodeId from, Time now, bool folded) {
  relay_.input_gap(now);
  membership_.input_up(from, folded, now);
}

void Blocks::input_lost(Time now) {
  relay_.input_gap(now);
  membership_.input_lost(now);
}

void Blocks::output_up(NodeId to, Time now, bool folded) {
  output_replaced(now);
  relay_.set_successor(to);
  membership_.output_up(to, folded, now);
}

void Blocks::output_lost(Time now) {
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

void Blocks::receive(const wire::Slice& slice, Time now) {
  if (relay_.receive(slice, now)) return;  // the usual case: it is on the line already
  // Where the line takes time, everything that comes in at one instant competes for it (run());
  // where it takes none, what has come in goes on at once, so that a batch never fills the buffer.
  const bool goes_on = settings_.byte_time_out.count() == 0;
  act(goes_on, now);
}

void Blocks::cpu_reset(Owner cpu, Time now) {
  transmit_.cancel(cpu, now);
  receive_.flush();
}

// ---- time ---------------------------------------------------------------------------------

void Blocks::handle_timeout(Time now) {
  relay_.handle_timeout(now);
  transmit_.handle_timeout(now);
  membership_.handle_timeout(now);
}

void Blocks::run(Time now) {
  act(true, now);
  act(false, now);  // a send into an open chain ends as it leaves, and may use up the sequence numbers
}

// Ends first: a send that has ended decides what may go onto the line.
void Blocks::act(bool goes_on, Time now) {
  membership_.settle(now);
  if (goes_on) packet_manager_.run(now);
}

Time Blocks::next_deadline(Time now) const {
  // A packet that the CPU does not read is no reason to wake up.
  const Time received = receive_.next() > now ? receive_.next() : kNever;
  const Time node = std::min(std::min(relay_.deadline(), transmit_.deadline()), membership_.deadline());
  return std::min(std::min(node, packet_manager_.deadline()), std::min(events_.next(), received));
}

}  // namespace limb_ring::core
