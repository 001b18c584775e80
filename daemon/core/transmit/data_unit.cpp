#include "core/transmit/data_unit.h"

#include <algorithm>
#include <cstring>

#include "core/mutation.h"

namespace limb_ring::core {

void count_outcome(Counters& counters, Outcome outcome) {
  switch (outcome) {
    case Outcome::delivered: ++counters.ended_delivered; break;
    case Outcome::refused: ++counters.ended_refused; break;
    case Outcome::no_such_node: ++counters.ended_no_such_node; break;
    case Outcome::lost: ++counters.ended_lost; break;
    case Outcome::unconfirmed: ++counters.ended_unconfirmed; break;
    case Outcome::rejected: ++counters.ended_rejected; break;
    case Outcome::cancelled: ++counters.ended_cancelled; break;
  }
}

DataUnit::DataUnit(const Settings& settings, Counters& counters, EventQueue& events)
    : settings_(settings), counters_(counters), events_(events) {}

void DataUnit::push(Queue& queue, const SendRequest& request, Time now) {
  Job& job = queue.push();
  ++jobs_;
  static_cast<JobState&>(job) = {};
  job.owner = request.owner;
  job.token = request.token;
  job.destination = request.destination;
  job.pri = wire::pri_byte(request.priority, request.channel);
  job.asked = job.not_before = now;
  job.backoff = settings_.refused_backoff;
  job.size = static_cast<std::uint16_t>(request.data.size);
  std::memcpy(job.data.data(), request.data.data, request.data.size);
}

Reject DataUnit::enqueue(const SendRequest& request, Time now) {
  Queue& queue = queues_[1 + request.priority];
  if (queue.size() >= settings_.send_queue) return Reject::queue_full;
  push(queue, request, now);
  return Reject::none;
}

void DataUnit::enqueue_control(wire::ByteView message, std::uint32_t token, Time now) {
  push(queues_[kControlQueue],
       {kController, token, wire::kBroadcast, 0, static_cast<std::uint8_t>(wire::Channel::control), message},
       now);
}

void DataUnit::set_open_chain(bool open, Time now) {
  open_chain_ = open;
  if (open && busy()) finish_flight(Outcome::unconfirmed, now);
}

Time DataUnit::front_ready(std::size_t queue) const {
  if (queues_[queue].empty() || gate_ == Gate::closed) return kNever;
  if (gate_ == Gate::control && queue != kControlQueue) return kNever;
  return std::max(queues_[queue].front().not_before, free_at_);
}

Time DataUnit::next_ready() const {
  Time ready = kNever;
  for (std::size_t q = 0; q < kQueues; ++q) ready = std::min(ready, front_ready(q));
  return ready;
}

// A refused unicast stays at the head of its priority and holds only that one back.
std::size_t DataUnit::choose(Time now) const {
  std::size_t q = 0;
  while (front_ready(q) > now) ++q;
  return q;
}

void DataUnit::load(Job& job) {
  const wire::Code code = numbers_.next(false, job.destination);
  std::memcpy(flight_.load(code, settings_.id, job.destination, job.pri, job.size), job.data.data(), job.size);
}

wire::ByteView DataUnit::start(Time now) {
  if (flight_.idle()) {
    current_ = choose(now);
    current().forgotten = false;
    load(current());
  } else {
    ++counters_.retries;
  }
  ++counters_.sent_data;
  ++current().tries;
  const wire::ByteView image = flight_.launch(now, settings_.send_timeout());
  if (open_chain_) {
    finish_flight(Outcome::unconfirmed, now);
    free_at_ = now + settings_.open_chain_pace();
  } else if (broken(Mutation::does_not_wait) && current().owner != kController) {
    finish_flight(Outcome::unconfirmed, now);
  }
  return image;
}

bool DataUnit::returned(const wire::PacketFields& packet, std::uint8_t fbc, bool doubtful, Time at) {
  if (!flight_.is_return(packet)) return false;
  ++counters_.returned_data;
  if (doubtful && current_ != kControlQueue) return give_up(at), true;
  decide(fbc, at, at - flight_.sent_at());
  return true;
}

void DataUnit::decide(std::uint8_t fbc, Time at, Duration round_trip) {
  const bool sure = !current().repeated;
  if (fbc == wire::kFbcUntaken && !broken(Mutation::says_delivered)) {
    numbers_.undecided(flight_.destination());
    return finish_flight(sure ? Outcome::no_such_node : Outcome::lost, at, round_trip);
  }
  numbers_.decided(flight_.destination());
  if (fbc != 0) return finish_flight(Outcome::delivered, at, round_trip);
  // The refusal of a receiver that has restarted says nothing of an earlier try.
  const bool doubtful = current().forgotten && !sure;
  const bool again = current().destination != wire::kBroadcast && !current().told && !doubtful;
  if (again && at < current().refused_until) return refuse(at);
  finish_flight(sure ? Outcome::refused : Outcome::lost, at, round_trip);
}

// The packet is back, so the slot is free; it goes again later, as a new packet.
void DataUnit::refuse(Time at) {
  ++counters_.refusals;
  Job& job = current();
  if (job.refused_until == kNever) job.refused_until = at + settings_.refused_for;
  job.not_before = std::min(at + job.backoff, job.refused_until);
  job.backoff = std::min(2 * job.backoff, settings_.refused_backoff_most);
  flight_.clear();
  free_at_ = at;
  if (broken(Mutation::refused_goes_last)) {
    const Job last = job;
    queues_[current_].pop();
    queues_[current_].push() = last;
  }
}

void DataUnit::returned_damaged(Time at) {
  if (flight_.phase() == Flight::Phase::out) fail_try(at);
}

void DataUnit::fail_try(Time at) {
  current().repeated = true;
  if (!current().told && !current().forgotten && flight_.retry(at)) return;
  give_up(at);
}

void DataUnit::give_up(Time at) {
  numbers_.undecided(flight_.destination());
  finish_flight(Outcome::lost, at);
}

void DataUnit::finish_flight(Outcome outcome, Time at, Duration round_trip) {
  flight_.clear();
  free_at_ = at;
  finish(current_, outcome, at, round_trip);
}

void DataUnit::finish(std::size_t queue, Outcome outcome, Time at, Duration round_trip) {
  tell(queues_[queue].front(), outcome, outcome == Outcome::rejected ? Reject::no_way_out : Reject::none, at,
       round_trip);
  pop(queues_[queue]);
}

void DataUnit::tell(Job& job, Outcome outcome, Reject reject, Time at, Duration round_trip) {
  if (job.told) return;
  job.told = true;
  const SendEnded ended{job.owner, job.token, outcome, reject, round_trip, job.tries, false, job.destination};
  if (job.owner == kController) {
    control_ends_.push_back(ended);
    return;
  }
  count_outcome(counters_, outcome);
  events_.put(at, ended);
  if (broken(Mutation::result_twice)) events_.put(at, ended);
}

// A job that waits after a try was refused; any other end would have been final.
Outcome DataUnit::overdue_outcome(const Job& job) {
  if (job.tries == 0) return Outcome::rejected;
  return job.repeated ? Outcome::lost : Outcome::refused;
}

void DataUnit::handle_timeout(Time now) {
  if (flight_.deadline() <= now) {
    ++counters_.timeouts;
    fail_try(now);
  }
  if (!any_waits()) return;
  if (flight_.phase() == Flight::Phase::waiting && flight_.waiting_since() + settings_.queue_timeout <= now)
    give_up(now);
  for (std::size_t q = 0; q < kQueues; ++q) {
    const auto overdue = [&] {
      return !queues_[q].empty() && (flight_.idle() || q != current_) &&
             queues_[q].front().asked + settings_.queue_timeout <= now;
    };
    while (overdue()) finish(q, overdue_outcome(queues_[q].front()), now);
  }
}

Time DataUnit::waiting_deadline() const {
  Time deadline = flight_.deadline();
  if (flight_.phase() == Flight::Phase::waiting) deadline = flight_.waiting_since() + settings_.queue_timeout;
  for (std::size_t q = 0; q < kQueues; ++q)
    if (!queues_[q].empty() && (flight_.idle() || q != current_))
      deadline = std::min(deadline, queues_[q].front().asked + settings_.queue_timeout);
  return deadline;
}

void DataUnit::forgotten_by(NodeId peer, Time now) {
  end_doubtful_refused(peer, now);
  if (flight_.idle() || current().owner == kController) return;
  if (current().destination != peer && current().destination != wire::kBroadcast) return;
  current().forgotten = true;
  if (flight_.phase() == Flight::Phase::waiting && current().repeated) give_up(now);
}

// A repeated packet may have been taken before the receiver restarted and refused after it.
void DataUnit::end_doubtful_refused(NodeId peer, Time now) {
  for (std::size_t q = 1; q < kQueues; ++q) {
    const bool waits = !queues_[q].empty() && (flight_.idle() || q != current_);
    if (waits && queues_[q].front().repeated && queues_[q].front().destination == peer) finish(q, Outcome::lost, now);
  }
}

void DataUnit::cancel(Owner owner, Time now) {
  jobs_ = 0;
  for (std::size_t q = 0; q < kQueues; ++q) {
    Queue& queue = queues_[q];
    for (std::size_t i = 0; i < queue.size(); ++i)
      if (queue[i].owner == owner) tell(queue[i], Outcome::cancelled, Reject::none, now, Duration{0});
    queue.erase_if(!flight_.idle() && q == current_ ? 1 : 0, [](const Job& job) { return job.told; });
    jobs_ += queue.size();
  }
}

void DataUnit::restart(Time now) {
  for (Queue& queue : queues_) {
    for (std::size_t i = 0; i < queue.size(); ++i)
      if (queue[i].owner != kController) tell(queue[i], Outcome::cancelled, Reject::none, now, Duration{0});
    queue.clear();
  }
  jobs_ = 0;
  control_ends_.clear();
  flight_.clear();
}

bool DataUnit::take_control_end(SendEnded& out) {
  if (control_ends_.empty()) return false;
  out = control_ends_.front();
  control_ends_.pop_front();
  return true;
}

}  // namespace limb_ring::core
