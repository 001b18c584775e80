#include "core/transmit/transmit.h"

#include "wire/packet.h"

namespace limb_ring::core {

Reject Transmit::check(const SendRequest& request) const {
  if (request.data.size < 1 || request.data.size > wire::kMaxPayload) return Reject::bad_size;
  if (request.priority >= wire::kPriorities) return Reject::bad_priority;
  if (request.channel >= wire::kChannels || request.channel == wire::id_of(wire::Channel::control))
    return Reject::bad_channel;
  return exists(request.destination) ? Reject::none : Reject::bad_destination;
}

Reject Transmit::check(const InterruptRequest& request) const {
  if (request.factor >= wire::kFactors) return Reject::bad_factor;
  return exists(request.destination) ? Reject::none : Reject::bad_destination;
}

void Transmit::send(const SendRequest& request, bool in_ring, Time now) {
  Reject reason = check(request);
  if (reason == Reject::none && !in_ring) reason = Reject::not_in_ring;
  if (reason == Reject::none) reason = data.enqueue(request, now);
  if (reason != Reject::none) reject(request, reason, now);
}

void Transmit::interrupt(const InterruptRequest& request, bool in_ring, Time now) {
  Reject reason = check(request);
  if (reason == Reject::none && !in_ring) reason = Reject::not_in_ring;
  if (reason == Reject::none) reason = interrupts.enqueue(request, now);
  if (reason != Reject::none) reject(request, reason, now);
}

void Transmit::pull(Owner owner, std::uint32_t token, unsigned input, bool in_ring, Time now) {
  InterruptRequest request;
  request.owner = owner;
  request.token = token;
  const bool wired = input < settings_.inputs.size() && settings_.inputs[input];
  if (!wired) return reject(request, Reject::input_unwired, now);
  request.destination = settings_.inputs[input]->destination;
  request.factor = settings_.inputs[input]->factor;
  interrupt(request, in_ring, now);
}

template <class Request>
void Transmit::reject(const Request& request, Reject reason, Time now) {
  ++counters_.ended_rejected;
  SendEnded ended = end_of(request);
  ended.reject = reason;
  events_.put(now, ended);
}

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
