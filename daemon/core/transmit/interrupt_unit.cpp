#include "core/transmit/interrupt_unit.h"

namespace limb_ring::core {

Reject InterruptUnit::enqueue(const InterruptRequest& request, Time now) {
  if (queue_.size() >= settings_.send_queue) return Reject::queue_full;
  Send& send = queue_.emplace_back();
  send.end = end_of(request);
  send.asked = now;
  return Reject::none;
}

wire::ByteView InterruptUnit::start(Time now) {
  const SendEnded& send = queue_.front().end;
  if (flight_.idle())
    flight_.load(numbers_.next(true, send.destination), settings_.id, send.destination, send.factor, 0);
  else
    ++counters_.retries;
  ++counters_.sent_interrupts;
  const wire::ByteView image = launch(now);
  if (!busy()) free_at_ = now + settings_.open_chain_interrupt_pace();
  return image;
}

void InterruptUnit::end_overdue(Time now) {
  handle_try_timeout(now);
  while (flight_.idle() && !queue_.empty() && overdue_at(queue_.front()) <= now)
    end_outstanding(Outcome::rejected, now);
}

void InterruptUnit::cancel(Owner owner, Time now) {
  for (Send& send : queue_)
    if (send.end.owner == owner) tell(send, Outcome::cancelled, now);
  const auto keep = queue_.begin() + (flight_.idle() ? 0 : 1);
  queue_.erase(std::remove_if(keep, queue_.end(), [](const Send& send) { return send.told; }), queue_.end());
  give_up_told_retry(now);
}

void InterruptUnit::restart(Time now) {
  for (Send& send : queue_) tell(send, Outcome::cancelled, now);
  queue_.clear();
  flight_.clear();
}

}  // namespace limb_ring::core
