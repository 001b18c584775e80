// Transmit: protocol.md section 4, and 5.1 for INTPs.
#include <algorithm>

#include "model/node.h"

namespace limb_ring::model {

// ---- asking: protocol.md sections 4.5 and 4.6 ---------------------------------------------------------------

void Node::ask(const core::SendRequest& request, Time now) {
  Send send;
  send.owner = request.owner;
  send.token = request.token;
  send.destination = request.destination;
  send.last = request.channel << 2 | (request.priority & 3);
  send.data.assign(request.data.begin(), request.data.end());
  Reject reject = Reject::none;
  if (send.data.empty() || send.data.size() > 512)
    reject = Reject::bad_size;
  else if (request.priority > 3)
    reject = Reject::bad_priority;
  else if (request.channel > 63 || request.channel == 1)
    reject = Reject::bad_channel;
  enqueue(data_, 1 + (request.priority & 3), send, now, reject);
}

void Node::ask(const core::InterruptRequest& request, Time now) {
  Send send;
  send.interrupt = true;
  send.owner = request.owner;
  send.token = request.token;
  send.destination = request.destination;
  send.last = request.factor;
  enqueue(interrupts_, 0, send, now, request.factor > 7 ? Reject::bad_factor : Reject::none);
}

// protocol.md section 5.4.
void Node::pull(core::Owner owner, std::uint32_t token, unsigned input, Time now) {
  if (input < 8 && settings_.inputs[input])
    return ask(
        core::InterruptRequest{owner, token, settings_.inputs[input]->destination, settings_.inputs[input]->factor},
        now);
  Send send;
  send.interrupt = true;
  send.owner = owner;
  send.token = token;
  end(send, Outcome::rejected, Reject::input_unwired, Duration{0}, now);
}

void Node::enqueue(Unit& unit, std::size_t queue, Send send, Time now, Reject reject) {
  send.asked = send.due = now;
  if (reject == Reject::none && !configured(send.destination) && send.destination != kAll)
    reject = Reject::bad_destination;
  if (reject == Reject::none && !closed() && state_ != NodeState::open_chain) reject = Reject::not_in_ring;
  std::size_t waiting = unit.queues[queue].size();
  if (unit.flight && !unit.flight->send.control() && (unit.interrupt || 1u + (unit.flight->send.last & 3) == queue))
    ++waiting;
  if (reject == Reject::none && waiting >= settings_.send_queue) reject = Reject::queue_full;
  if (reject != Reject::none) return end(send, Outcome::rejected, reject, Duration{0}, now);
  unit.queues[queue].push_back(send);
}

// ---- ends -------------------------------------------------------------------------------------------

void Node::end(Send& send, Outcome outcome, Reject reject, Duration round_trip, Time at) {
  if (send.cancelled) return;
  send.cancelled = true;
  if (send.control()) return control_ended(send, outcome, now_);
  core::SendEnded ended;
  ended.owner = send.owner;
  ended.token = send.token;
  ended.outcome = outcome;
  ended.reject = reject;
  ended.round_trip = round_trip;
  ended.tries = send.tries;
  ended.interrupt = send.interrupt;
  ended.destination = wire::NodeId{static_cast<std::uint8_t>(send.destination)};
  if (send.interrupt) ended.factor = wire::Factor{static_cast<std::uint8_t>(send.last)};
  tell(at, ended);
}

/// The slot is free at that time.
void Node::end_flight(Unit& unit, Outcome outcome, Duration round_trip, Time at, bool verdict) {
  Flight flight = std::move(*unit.flight);
  unit.flight.reset();
  unit.free_since = at;
  Numbers& numbers = unit.numbers[flight.send.destination];
  numbers.without_verdict = verdict ? 0 : numbers.without_verdict + 1;
  if (numbers.without_verdict >= 6) new_hello_wanted_ = true;  // protocol.md section 4.7
  end(flight.send, outcome, Reject::none, round_trip, at);
}

void Node::cancel(core::Owner owner, Time now) {
  for (Unit* unit : {&data_, &interrupts_}) {
    for (auto& queue : unit->queues) {
      for (auto send = queue.begin(); send != queue.end();) {
        if (send->owner != owner) {
          ++send;
          continue;
        }
        end(*send, Outcome::cancelled, Reject::none, Duration{0}, now);
        send = queue.erase(send);
      }
    }
    if (!unit->flight || unit->flight->send.owner != owner) continue;
    if (unit->flight->waits_since)
      end_flight(*unit, Outcome::cancelled, Duration{0}, now, false);
    else
      end(unit->flight->send, Outcome::cancelled, Reject::none, Duration{0}, now);
  }
}

/// Nothing is left.
void Node::cancel_all(Time now) {
  hello_out_ = beacon_out_ = false;
  for (Unit* unit : {&data_, &interrupts_}) {
    for (auto& queue : unit->queues) {
      for (Send& send : queue)
        if (!send.control()) end(send, Outcome::cancelled, Reject::none, Duration{0}, now);
      queue.clear();
    }
    if (unit->flight && !unit->flight->send.control())
      end(unit->flight->send, Outcome::cancelled, Reject::none, Duration{0}, now);
    if (unit->flight) unit->free_since = now;  // the pace of an open chain goes on (protocol.md section 7.4)
    unit->flight.reset();
  }
}

/// A head that waits after a refusal ends: what it has held back is due from now on. (protocol.md section 4.4)
void Node::end_refused_head(std::deque<Send>& queue, Outcome outcome, Time at) {
  Send send = queue.front();
  queue.pop_front();
  if (!queue.empty()) queue.front().due = std::max(queue.front().due, at);
  end(send, outcome, Reject::none, Duration{0}, at);
}

/// A break is known. (protocol.md section 8.4)
void Node::end_unconfirmed(Time now) {
  for (Unit* unit : {&data_, &interrupts_}) {
    if (unit->flight) end_flight(*unit, Outcome::unconfirmed, Duration{0}, now, true);
    for (auto& queue : unit->queues) {
      if (queue.empty() || !queue.front().repeated) continue;
      end_refused_head(queue, Outcome::unconfirmed, now);
    }
  }
}

// ---- tries: protocol.md sections 4.2 to 4.4 ---------------------------------------------------------------------

void Node::try_failed(Unit& unit, Time at) {
  Flight& flight = *unit.flight;
  flight.send.repeated = true;
  flight.waits_until = at + settings_.queue_timeout;
  if (falls_into_parts() && !flight.send.control())
    flight.waits_until = std::min(flight.waits_until, flight.first_left + 4 * try_timeout());
  if (flight.send.cancelled || flight.not_repeated || flight.attempt == 3 || flight.waits_until <= at)
    return end_flight(unit, Outcome::lost, Duration{0}, at, false);
  flight.waits_since = at;
}

void Node::returned(const Packet& packet, Time at, Time now) {
  Unit& unit = packet.interrupt() ? interrupts_ : data_;
  Packet as_sent = packet;
  as_sent.rewrite(0, 0xFF);
  if (!unit.flight || as_sent.bytes != unit.flight->sent.bytes) return control_home_unmatched(packet, at);
  int fbc = packet.fbc();
  if (packet.destination() == id() && closed()) fbc = answer(packet, at, now);
  const bool grown = grows_together(packet, now);
  own_home(packet, at, now);
  const Duration round_trip = at - unit.flight->left;
  Send& send = unit.flight->send;
  const bool again = !send.interrupt && !packet.broadcast() && !send.cancelled &&
                     (!send.first_refusal || at < *send.first_refusal + settings_.refused_for);
  if (grown && !send.control()) return end_flight(unit, Outcome::lost, Duration{0}, at, true);
  if (fbc == 0xFF)
    return end_flight(unit, send.repeated ? Outcome::lost : Outcome::no_such_node, round_trip, at, false);
  if (fbc != 0) return end_flight(unit, Outcome::delivered, round_trip, at, true);
  if (send.repeated && (send.destination_restarted || unit.flight->not_repeated))
    return end_flight(unit, Outcome::lost, round_trip, at, true);
  if (again) return refused(unit, at);
  end_flight(unit, send.repeated ? Outcome::lost : Outcome::refused, round_trip, at, true);
}

// protocol.md section 4.4: it stays at the head of its priority.
void Node::refused(Unit& unit, Time at) {
  Send send = unit.flight->send;
  unit.numbers[send.destination].without_verdict = 0;
  unit.flight.reset();
  unit.free_since = at;
  if (!send.first_refusal) {
    send.first_refusal = at;
    send.back_off = settings_.refused_backoff;
  } else {
    send.back_off = std::min(2 * send.back_off, settings_.refused_backoff_most);
  }
  send.due = std::min(at + send.back_off, *send.first_refusal + settings_.refused_for);
  unit.queues[static_cast<std::size_t>(1 + (send.last & 3))].push_front(send);
}

// ---- the next packet: protocol.md sections 2.4, 4.5 and 4.8 -----------------------------------------------------

bool Node::may_go(const Send& send) const {
  if (send.hello()) return state_ != NodeState::starting;
  if (state_ == NodeState::open_chain) return hello_left_;
  return closed() && !hello_out_ && !new_hello_wanted_;
}

/// Since when the unit waits for the line; nothing: it has nothing to send.
std::optional<Time> Node::own_since(const Unit& unit) const {
  if (unit.flight) return unit.flight->waits_since;
  std::optional<Time> since;
  for (const auto& queue : unit.queues)
    if (!queue.empty() && may_go(queue.front()))
      since = since ? std::min(*since, queue.front().due) : queue.front().due;
  if (!since) return since;
  return std::max({*since, unit.free_since, allowed_since_});
}

/// The queue of the highest priority that is due.
std::optional<std::size_t> Node::choose(const Unit& unit, Time now) const {
  for (std::size_t queue = 0; queue < unit.queues.size(); ++queue)
    if (!unit.queues[queue].empty() && may_go(unit.queues[queue].front()) && unit.queues[queue].front().due <= now)
      return queue;
  return std::nullopt;
}

/// The packet that goes onto the line now.
Packet Node::launch(Unit& unit, Time now) {
  if (unit.flight) {
    ++unit.flight->attempt;
    unit.flight->waits_since.reset();
  } else {
    auto& queue = unit.queues[*choose(unit, now)];
    Flight flight;
    flight.send = queue.front();
    queue.pop_front();
    Numbers& numbers = unit.numbers[flight.send.destination];
    flight.sequence = numbers.next;
    numbers.next = (numbers.next + 1) % 8;
    unit.flight = flight;
  }
  Flight& flight = *unit.flight;
  ++flight.send.tries;
  flight.left = now;
  if (flight.attempt == 0) flight.first_left = now;
  const int code = code_byte(boot_, unit.interrupt, flight.attempt, flight.sequence);
  flight.sent = make_packet(code, id(), flight.send.destination, flight.send.last, flight.send.data);
  const Packet packet = flight.sent;
  if (state_ != NodeState::open_chain) return packet;
  // protocol.md section 8.4: it does not wait for the return, but for its turn.
  end_flight(unit, Outcome::unconfirmed, Duration{0}, now, true);
  const Duration pace =
      unit.interrupt ? count_nodes() * (24 * settings_.byte_time_out + settings_.relay_delay) : worst_lap();
  unit.free_since = now + std::max(pace, settings_.unconfirmed_pace);
  return packet;
}

// ---- time: protocol.md sections 4.3 and 4.5 -----------------------------------------------------------------------

void Node::unit_timers(Unit& unit, Time now) {
  if (unit.flight && unit.flight->waits_since && unit.flight->waits_until <= now)
    end_flight(unit, Outcome::lost, Duration{0}, now, false);
  if (unit.flight && !unit.flight->waits_since && unit.flight->left + try_timeout() <= now) try_failed(unit, now);
  for (auto& queue : unit.queues) {
    while (!queue.empty() && queue.front().asked + settings_.queue_timeout <= now) {
      Send send = queue.front();
      queue.pop_front();
      const Outcome outcome = send.tries == 0 ? Outcome::rejected : send.repeated ? Outcome::lost : Outcome::refused;
      end(send, outcome, send.tries == 0 ? Reject::no_way_out : Reject::none, Duration{0}, now);
    }
  }
}

Time Node::unit_deadline(const Unit& unit) const {
  Time next = kNever;
  if (unit.flight) next = unit.flight->waits_since ? unit.flight->waits_until : unit.flight->left + try_timeout();
  for (const auto& queue : unit.queues)
    if (!queue.empty()) next = std::min(next, queue.front().asked + settings_.queue_timeout);
  return next;
}

// protocol.md section 4.10, what is outstanding to a node that has started again.
void Node::destination_restarted(int source, Time now) {
  for (Unit* unit : {&data_, &interrupts_}) {
    for (auto& queue : unit->queues) {
      if (queue.empty() || queue.front().destination != source || !queue.front().repeated) continue;
      end_refused_head(queue, Outcome::lost, now);
    }
    if (!unit->flight || unit->flight->send.control()) continue;
    const int to = unit->flight->send.destination;
    if (to != source && to != kAll) continue;
    unit->flight->not_repeated = true;
    if (unit->flight->waits_since) end_flight(*unit, Outcome::lost, Duration{0}, now, false);
  }
}

}  // namespace limb_ring::model
