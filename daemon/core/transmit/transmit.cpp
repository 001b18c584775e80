#include "core/transmit/transmit.h"

#include <algorithm>

#include "wire/interrupt_packet.h"

namespace limb_ring::core {

bool Transmit::exists(NodeId destination) const {
  const auto& order = settings_.order;
  return destination == wire::kBroadcast || std::find(order.begin(), order.end(), destination) != order.end();
}

Reject Transmit::check(const SendRequest& request) const {
  if (request.data.size < 1 || request.data.size > wire::kMaxPayload) return Reject::bad_size;
  if (request.priority > 3) return Reject::bad_priority;
  if (request.channel > 63 || request.channel == wire::id_of(wire::Channel::control)) return Reject::bad_channel;
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
  if (reason == Reject::none) return;
  SendEnded ended;
  ended.owner = request.owner;
  ended.token = request.token;
  ended.destination = request.destination;
  reject(ended, reason, now);
}

void Transmit::interrupt(const InterruptRequest& request, bool in_ring, Time now) {
  Reject reason = check(request);
  if (reason == Reject::none && !in_ring) reason = Reject::not_in_ring;
  if (reason == Reject::none) reason = interrupts.enqueue(request, now);
  if (reason == Reject::none) return;
  SendEnded ended;
  ended.owner = request.owner;
  ended.token = request.token;
  ended.interrupt = true;
  ended.destination = request.destination;
  ended.factor = request.factor;
  reject(ended, reason, now);
}

void Transmit::pull(Owner owner, std::uint32_t token, unsigned input, bool in_ring, Time now) {
  InterruptRequest request;
  request.owner = owner;
  request.token = token;
  const bool wired = input < settings_.inputs.size() && settings_.inputs[input];
  if (wired) {
    request.destination = settings_.inputs[input]->destination;
    request.factor = settings_.inputs[input]->factor;
    return interrupt(request, in_ring, now);
  }
  SendEnded ended;
  ended.owner = owner;
  ended.token = token;
  ended.interrupt = true;
  reject(ended, Reject::input_unwired, now);
}

void Transmit::reject(SendEnded ended, Reject reason, Time now) {
  ++counters_.ended_rejected;
  ended.outcome = Outcome::rejected;
  ended.reject = reason;
  events_.put(now, ended);
}

}  // namespace limb_ring::core
