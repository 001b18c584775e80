#include "tools/ringctl/live/live_senders.h"
#include "core/time.h"
#include "io/signal_wait.h"

#include <algorithm>

namespace limb_ring::ringctl {

using nlohmann::json;
using scenario::Scenario;
using scenario::Send;
using scenario::Step;
using scenario::Tally;

LiveSenders::LiveSenders(const Scenario& scenario, LiveNodes& nodes, std::uint64_t seed)
    : scenario_(scenario), nodes_(nodes), random_(seed), hung_(nodes.size(), false) {
  for (const Step& step : scenario.steps) {
    const auto* send = std::get_if<Send>(&step.action);
    if (send && std::find(names_.begin(), names_.end(), send->name) == names_.end()) names_.push_back(send->name);
  }
  tallies_.resize(names_.size());
}

std::uint8_t LiveSenders::mark_of(const std::string& send) const {
  return static_cast<std::uint8_t>(std::find(names_.begin(), names_.end(), send) - names_.begin());
}

std::uint8_t LiveSenders::id_of(std::uint8_t place_or_all) const {
  return place_or_all == wire::kBroadcast ? kBroadcast : scenario_.ring.nodes[place_or_all].id;
}

// ---- what is sent ---------------------------------------------------------------------------

void LiveSenders::begin(const Send& send) {
  for (const auto from : send.from) {
    Job& job = jobs_.emplace_back(Job{send, from, mark_of(send.name), send.times(), Clock::now()});
    if (send.is_stream())
      job.due += std::chrono::nanoseconds(random_() % static_cast<std::uint64_t>(send.every.count()));
    else
      while (job.left != 0) ask(job);
  }
}

LiveSenders::Clock::time_point LiveSenders::act() {
  const auto now = Clock::now();
  auto next = Clock::time_point::max();
  for (Job& job : jobs_) {
    if (now - job.due > process::Standstill::kLeast) job.due = now;  // this process or its machine stood still
    while (job.left != 0 && job.due <= now && job.waiting < kMostWaiting) {
      ask(job);
      job.due += job.send.every;
    }
    if (job.left != 0 && job.waiting < kMostWaiting) next = std::min(next, job.due);
  }
  return next;
}

bool LiveSenders::can_send(const Job& job) {
  if (!nodes_.running(job.from) || !nodes_.port(job.from)) return false;
  if (job.send.input) return true;
  const json* row = nodes_.row(job.from);
  const std::string cpu = row ? row->at("cpu").value("state", "") : "";
  return !hung_[job.from] && (cpu == "running" || cpu == "silent");  // silent: it was hung a moment ago
}

void LiveSenders::ask(Job& job) {
  --job.left;
  if (!can_send(job)) return;
  const auto at = Clock::now();
  asked_[{job.from, ask(*nodes_.port(job.from), job)}] = {&job, at};
  ++job.waiting;
}

std::uint32_t LiveSenders::ask(HostPort& port, const Job& job) {
  const Send& send = job.send;
  if (send.input) {
    if (const auto& wire = scenario_.ring.nodes[job.from].inputs[*send.input])
      of_interrupt_[{port.id(), wire->factor}] = job.mark;
    return port.pull(*send.input);
  }
  if (send.interrupt) {
    of_interrupt_[{port.id(), *send.interrupt}] = job.mark;
    return port.interrupt(id_of(send.to), *send.interrupt, /*force=*/true);
  }
  return port.send(id_of(send.to), std::vector<std::uint8_t>(send.size, job.mark), send.priority);
}

// ---- what becomes of it ---------------------------------------------------------------------

void LiveSenders::came(std::size_t place, const Message& message) {
  if (const auto* result = std::get_if<Result>(&message)) came(place, *result);
  if (const auto* seen = std::get_if<Observed>(&message)) came(*seen);
}

void LiveSenders::came(std::size_t place, const Result& result) {
  const auto found = asked_.find({place, result.token});
  if (found == asked_.end()) return;
  const auto [job, at] = found->second;
  asked_.erase(found);
  --job->waiting;
  Tally& tally = tallies_[job->mark];
  ++tally.results[static_cast<std::size_t>(result.outcome)];
  if (result.outcome == Outcome::delivered) tally.worst = std::max<core::Duration>(tally.worst, Clock::now() - at);
}

void LiveSenders::came(const Observed& seen) {
  const json pin = json::parse(seen.json);
  const auto found = of_interrupt_.find({pin.value("source", std::uint8_t{0}), pin.value("factor", std::uint8_t{0})});
  if (pin.value("kind", "") == "pin" && found != of_interrupt_.end()) ++tallies_[found->second].taken;
}

}  // namespace limb_ring::ringctl
