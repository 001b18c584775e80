#include "core/transmit/interrupt_unit.h"

#include <algorithm>

namespace limb_ring::core {

InterruptUnit::InterruptUnit(const Settings& settings, Counters& counters, EventQueue& events)
    : settings_(settings), counters_(counters), events_(events) {}

Reject InterruptUnit::enqueue(const InterruptRequest& request, Time now) {
  if (queue_.size() >= settings_.send_queue) return Reject::queue_full;
  queue_.push_back({request, now});
  return Reject::none;
}

void InterruptUnit::set_open_chain(bool open, Time now) {
  open_chain_ = open;
  if (open && busy()) finish(Outcome::unconfirmed, now);
}

wire::ByteView InterruptUnit::start(Time now) {
  const InterruptRequest& request = queue_.front().request;
  if (flight_.idle())
    flight_.load(numbers_.next(true, request.destination), settings_.id, request.destination, request.factor,
                 0);
  else
    ++counters_.retries;
  ++counters_.sent_interrupts;
  ++queue_.front().tries;
  const wire::ByteView image = flight_.launch(now, settings_.send_timeout());
  if (open_chain_) {
    finish(Outcome::unconfirmed, now);
    free_at_ = now + settings_.open_chain_interrupt_pace();
  }
  return image;
}

bool InterruptUnit::returned(const wire::PacketFields& packet, std::uint8_t fbc, bool doubtful, Time at) {
  if (!flight_.is_return(packet)) return false;
  ++counters_.returned_interrupts;
  if (doubtful) return give_up(at), true;
  const bool sure = !queue_.front().repeated;
  Outcome outcome = Outcome::delivered;
  if (fbc == wire::kFbcUntaken) outcome = sure ? Outcome::no_such_node : Outcome::lost;
  if (fbc == 0) outcome = sure ? Outcome::refused : Outcome::lost;
  if (fbc == wire::kFbcUntaken)
    numbers_.undecided(flight_.destination());
  else
    numbers_.decided(flight_.destination());
  finish(outcome, at, at - flight_.sent_at());
  return true;
}

void InterruptUnit::returned_damaged(Time at) {
  if (flight_.phase() == Flight::Phase::out) fail_try(at);
}

void InterruptUnit::fail_try(Time at) {
  queue_.front().repeated = true;
  if (!queue_.front().told && !queue_.front().forgotten && flight_.retry(at)) return;
  give_up(at);
}

void InterruptUnit::give_up(Time at) {
  numbers_.undecided(flight_.destination());
  finish(Outcome::lost, at);
}

void InterruptUnit::finish(Outcome outcome, Time at, Duration round_trip) {
  flight_.clear();
  free_at_ = at;
  tell(queue_.front(), outcome, at, round_trip);
  queue_.pop_front();
}

void InterruptUnit::tell(Job& job, Outcome outcome, Time at, Duration round_trip) {
  if (job.told) return;
  job.told = true;
  count_outcome(counters_, outcome);
  const Reject reject = outcome == Outcome::rejected ? Reject::no_way_out : Reject::none;
  events_.put(at, SendEnded{job.request.owner, job.request.token, outcome, reject, round_trip, job.tries, true,
                            job.request.destination, job.request.factor});
}

void InterruptUnit::end_overdue(Time now) {
  if (flight_.deadline() <= now) {
    ++counters_.timeouts;
    fail_try(now);
  }
  if (flight_.phase() == Flight::Phase::waiting && flight_.waiting_since() + settings_.queue_timeout <= now)
    give_up(now);
  while (flight_.idle() && !queue_.empty() && queue_.front().asked + settings_.queue_timeout <= now)
    finish(Outcome::rejected, now);
}

Time InterruptUnit::next_deadline() const {
  if (flight_.phase() == Flight::Phase::waiting) return flight_.waiting_since() + settings_.queue_timeout;
  if (!flight_.idle()) return flight_.deadline();
  return queue_.front().asked + settings_.queue_timeout;
}

void InterruptUnit::forgotten_by(NodeId peer, Time now) {
  if (flight_.idle()) return;
  const NodeId destination = queue_.front().request.destination;
  if (destination != peer && destination != wire::kBroadcast) return;
  queue_.front().forgotten = true;
  if (flight_.phase() == Flight::Phase::waiting && queue_.front().repeated) give_up(now);
}

void InterruptUnit::cancel(Owner owner, Time now) {
  for (Job& job : queue_)
    if (job.request.owner == owner) tell(job, Outcome::cancelled, now, Duration{0});
  const auto keep = queue_.begin() + (flight_.idle() ? 0 : 1);
  queue_.erase(std::remove_if(keep, queue_.end(), [](const Job& job) { return job.told; }), queue_.end());
}

void InterruptUnit::restart(Time now) {
  for (Job& job : queue_) tell(job, Outcome::cancelled, now, Duration{0});
  queue_.clear();
  flight_.clear();
}

}  // namespace limb_ring::core
