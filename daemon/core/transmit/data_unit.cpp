#include "core/transmit/data_unit.h"

#include <cstring>

namespace limb_ring::core {

// ---- queues ---------------------------------------------------------------------------------

void DataUnit::push(Queue& queue, const SendRequest& request, Time now) {
  Job& job = queue.push();
  ++jobs_;
  static_cast<JobState&>(job) = {};
  job.end = end_of(request);
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
  SendRequest request;
  request.token = token;
  request.destination = wire::kBroadcast;
  request.channel = wire::id_of(wire::Channel::control);
  request.data = message;
  push(queues_[kControlQueue], request, now);
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

// ---- the packet outstanding -------------------------------------------------------------------

void DataUnit::load(const Job& job) {
  const NodeId destination = job.end.destination;
  const wire::Code code = numbers_.next(false, destination);
  std::memcpy(flight_.load(code, settings_.id, destination, job.pri, job.size), job.data.data(), job.size);
}

wire::ByteView DataUnit::start(Time now) {
  if (flight_.idle()) {
    current_ = choose(now);
    outstanding().forgotten = false;
    load(outstanding());
  } else {
    ++counters_.retries;
  }
  ++counters_.sent_data;
  const wire::ByteView image = launch(now);
  if (!busy()) free_at_ = now + settings_.open_chain_pace();
  return image;
}

// The packet is back, so the slot is free; it goes again later, as a new packet. If the receiver has restarted, its
// refusal says nothing of an earlier try.
bool DataUnit::goes_again(Time at) {
  Job& job = outstanding();
  const bool doubtful = job.forgotten && job.repeated;
  if (job.end.destination == wire::kBroadcast || job.told || doubtful || at >= job.refused_until) return false;
  ++counters_.refusals;
  if (job.refused_until == kNever) job.refused_until = at + settings_.refused_for;
  job.not_before = std::min(at + job.backoff, job.refused_until);
  job.backoff = std::min(2 * job.backoff, settings_.refused_backoff_most);
  flight_.clear();
  free_at_ = at;
  return true;
}

void DataUnit::give_out(const SendEnded& ended, Time at) {
  if (ended.owner == kController)
    control_ends_.push_back(ended);
  else
    SendUnit::give_out(ended, at);
}

bool DataUnit::take_control_end(SendEnded& out) {
  if (control_ends_.empty()) return false;
  out = control_ends_.front();
  control_ends_.pop_front();
  return true;
}

// ---- ends -------------------------------------------------------------------------------------

void DataUnit::end_waiting(Queue& queue, Outcome outcome, Time now) {
  tell(queue.front(), outcome, now);
  pop(queue);
  hold_next(queue, now);
}

void DataUnit::hold_next(Queue& queue, Time now) {
  if (!queue.empty()) queue.front().not_before = std::max(queue.front().not_before, now);
}

// A job that waits after a try was refused; any other end would have been final.
Outcome DataUnit::overdue_outcome(const Job& job) {
  if (job.end.tries == 0) return Outcome::rejected;
  return job.repeated ? Outcome::lost : Outcome::refused;
}

void DataUnit::end_overdue(Time now) {
  handle_try_timeout(now);
  if (!any_waits()) return;
  for (std::size_t q = 0; q < kQueues; ++q) {
    Queue& queue = queues_[q];
    while (front_waits(q) && overdue_at(queue.front()) <= now) end_waiting(queue, overdue_outcome(queue.front()), now);
  }
}

Time DataUnit::waiting_deadline() const {
  Time deadline = flight_.deadline();
  for (std::size_t q = 0; q < kQueues; ++q)
    if (front_waits(q)) deadline = std::min(deadline, overdue_at(queues_[q].front()));
  return deadline;
}

// A repeated packet may have been taken before the receiver restarted and refused after it.
template <class Predicate>
void DataUnit::end_doubtful(Outcome outcome, Time now, Predicate is_meant) {
  for (std::size_t q = kControlQueue + 1; q < kQueues; ++q) {
    Queue& queue = queues_[q];
    if (front_waits(q) && queue.front().repeated && is_meant(queue.front())) end_waiting(queue, outcome, now);
  }
}

void DataUnit::set_open_chain(bool open, Time now) {
  SendUnit::set_open_chain(open, now);
  if (open) end_doubtful(Outcome::unconfirmed, now, [](const Job&) { return true; });
}

void DataUnit::forgotten_by(NodeId peer, Time now) {
  end_doubtful(Outcome::lost, now, [&](const Job& job) { return job.end.destination == peer; });
  SendUnit::forgotten_by(peer, now);
}

void DataUnit::cancel(Owner owner, Time now) {
  jobs_ = 0;
  for (std::size_t q = 0; q < kQueues; ++q) {
    Queue& queue = queues_[q];
    for (std::size_t i = 0; i < queue.size(); ++i)
      if (queue[i].end.owner == owner) tell(queue[i], Outcome::cancelled, now);
    const bool head_goes = front_waits(q) && queue.front().told;
    queue.erase_if(!flight_.idle() && q == current_ ? 1 : 0, [](const Job& job) { return job.told; });
    if (head_goes) hold_next(queue, now);
    jobs_ += queue.size();
  }
  give_up_told_retry(now);
}

void DataUnit::restart(Time now) {
  for (Queue& queue : queues_) {
    for (std::size_t i = 0; i < queue.size(); ++i)
      if (queue[i].end.owner != kController) tell(queue[i], Outcome::cancelled, now);
    queue.clear();
  }
  jobs_ = 0;
  control_ends_.clear();
  flight_.clear();
}

}  // namespace limb_ring::core
