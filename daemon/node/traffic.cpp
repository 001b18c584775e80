#include "node/traffic.h"

#include "judge/percentiles.h"
#include "limb_ring/host_port.h"
#include "node/rejected_pause.h"
#include "node/send_owner.h"

namespace limb_ring::runtime {
namespace {

constexpr core::Owner kTrafficOwner = SendOwner::of(SendOwner::Kind::traffic).to_core();

}  // namespace

bool Traffic::start(const TrafficRequest& request, Done done) {
  if (runs_.size() >= kMostRuns) return false;
  const std::uint32_t id = ++last_id_;
  auto& run = *runs_.emplace(id, std::make_unique<Run>(request, std::move(done))).first->second;
  run.next = driver_.clock().timer([this, id] { send_next(id); });
  run.deadline = driver_.clock().timer([this, id] { overdue(id); });
  run.begun = run.last_end = driver_.now();
  run.deadline->expires_at(driver_.clock().now() + request.deadline);
  send(id, run);
  driver_.pump();
  return true;
}

void Traffic::overdue(std::uint32_t id) {
  runs_.at(id)->overdue = true;
  finish(id);
}

void Traffic::send(std::uint32_t id, Run& run) {
  wire::store_u32(run.data.data(), static_cast<std::uint32_t>(run.sent));  // no two alike
  ++run.sent;
  core::SendRequest request;
  request.owner = kTrafficOwner;
  request.token = id;
  request.destination = run.request.to;
  request.priority = wire::Priority{run.request.priority};
  request.data = {run.data.data(), run.request.size};
  driver_.controller().send(request, driver_.now());
}

void Traffic::send_next(std::uint32_t id) {
  const auto it = runs_.find(id);
  if (it == runs_.end()) return;
  send(id, *it->second);
  driver_.pump();
}

void Traffic::on_ended(const core::SendEnded& ended, const std::string& reason) {
  const auto it = runs_.find(ended.token);
  if (it == runs_.end()) return;
  Run& run = *it->second;
  run.last_end = driver_.now();
  ++run.outcomes[static_cast<std::size_t>(ended.outcome)];
  if (ended.outcome == core::Outcome::delivered)
    run.round_trips.push_back(ended.round_trip);
  else
    ++run.reasons[reason];
  if (complete(run)) return finish(ended.token);
  const auto pause = pause_after(ended.outcome, run.request.interval);
  if (pause.count() > 0)
    run.next->expires_at(driver_.clock().now() + pause);
  else
    send(ended.token, run);
}

bool Traffic::complete(const Run& run) {
  if (run.sent >= run.request.count) return true;
  return run.request.duration.count() > 0 && run.last_end - run.begun >= run.request.duration;
}

nlohmann::json Traffic::report(Run& run) {
  nlohmann::json other = nlohmann::json::object();
  for (std::size_t i = 0; i < run.outcomes.size(); ++i) {
    const auto outcome = static_cast<Outcome>(i);
    if (run.outcomes[i] != 0 && outcome != Outcome::delivered && outcome != Outcome::lost)
      other[to_string(outcome)] = run.outcomes[i];
  }
  const std::uint64_t delivered = run.outcomes[static_cast<std::size_t>(Outcome::delivered)];
  const double seconds = std::chrono::duration<double>(run.last_end - run.begun).count();
  return {{"sent", run.sent},
          {"delivered", delivered},
          {"lost", run.outcomes[static_cast<std::size_t>(Outcome::lost)]},
          {"other", other},
          {"reasons", run.reasons},
          {"overdue", run.overdue},
          {"round_trip_us", to_json(statistics::percentiles(run.round_trips))},
          {"seconds", seconds},
          {"packets_per_second", seconds > 0 ? static_cast<double>(delivered) / seconds : 0.0}};
}

void Traffic::finish(std::uint32_t id) {
  const auto it = runs_.find(id);
  const std::unique_ptr<Run> run = std::move(it->second);
  runs_.erase(it);
  run->done(report(*run));
}

}  // namespace limb_ring::runtime
