#include "node/event_router.h"

#include <spdlog/spdlog.h>

#include "judge/percentiles.h"
#include "limb_ring/host_port.h"
#include "node/send_reason.h"
#include "node/session.h"

namespace limb_ring::runtime {

// ---- from the network controller ----------------------------------------------------------

void EventRouter::on_event(const core::Event& event) {
  std::visit([this](const auto& what) { handle(what); }, event.what);
}

void EventRouter::on_round_end() {
  const core::NetworkController& controller = to_.driver.controller();
  to_.folder.note_boot(controller.membership().boot());
  if (controller.received_waiting() != 0) to_.cpu.hand_over();
  to_.observers.tell_changes(to_.driver);
  to_.lately_damaged.look(to_.driver.now(), to_.driver.controller().counters());
  if (to_.neighbours.is_due(to_.driver.now())) look_at_neighbours();
  to_.cpu.watch().look(to_.driver.now());
}

void EventRouter::look_at_neighbours() {
  const core::NetworkController& controller = to_.driver.controller();
  const core::Membership& membership = controller.membership();
  NeighbourWatch::Look look{to_.driver.now(),   controller.counters(),  membership.peers(),
                            membership.state(), membership.ring_size(), to_.driver.ends(core::Line::first).from};
  for (const core::Line line : core::Lines(to_.driver.has_second_line())) {
    const link::InputCounters& in = to_.driver.input_counters(line);
    look.no_slices += in.malformed;
    look.other_session += in.datagrams_stale;
    if (in.datagrams_stale != 0) look.other_session_of = in.last_stale_from;
    look.line_losses += in.losses + to_.driver.output_counters(line).losses;
  }
  look.last_loss = to_.driver.last_loss();
  for (const std::string& text : to_.neighbours.look(look)) spdlog::warn("{}{}", to_.log_prefix, text);
}

void EventRouter::log(process::Throttle& lines, std::string_view what) const {
  const auto held_back = lines.allow(to_.driver.clock().now());
  if (held_back) spdlog::info("{}{}{}", to_.log_prefix, what, process::and_more(*held_back));
}

std::string LinkChange::words() const {
  const std::string end = std::string(line == core::Line::second ? "second line: " : "") + (input ? "input" : "output");
  const std::string because = why.empty() ? "" : ": " + why;
  if (is == Is::lost) return end + " lost" + because;
  if (is == Is::up) return end + (input ? " from node " : " to node ") + std::to_string(*other);
  return end + (other ? ": node " + std::to_string(*other) : ": turned away") + because;
}

void EventRouter::on_link(const LinkChange& change) {
  constexpr const char* kIs[] = {"up", "lost", "refused"};
  const std::string words = change.words();
  log(link_lines_, words);
  to_.observers.tell("link", {{"end", change.input ? "input" : "output"},
                              {"second", change.line == core::Line::second},
                              {"is", kIs[static_cast<std::size_t>(change.is)]},
                              {"other", change.other ? nlohmann::json(*change.other) : nlohmann::json()},
                              {"what", words}});
}

void EventRouter::handle(const core::SendEnded& ended) {
  if (ended.outcome == core::Outcome::delivered) to_.round_trips.add(to_.driver.now(), ended.round_trip);
  const SendOwner owner = SendOwner::from_core(ended.owner);
  switch (owner.kind) {
    case SendOwner::Kind::client:
      return tell_client(owner.client, ended);
    case SendOwner::Kind::traffic:
      return to_.traffic.on_ended(ended, to_.reasons.of(ended).text);
    case SendOwner::Kind::daemon_interrupts:
      return to_.interrupts.on_ended(ended);
    case SendOwner::Kind::babbling_cpu:
      return to_.faults.on_ended(ended);
    case SendOwner::Kind::ring_user:
      return;  // it sees the events themselves
  }
}

void EventRouter::tell_client(host::ClientId client, const core::SendEnded& ended) {
  const auto round_trip = core::whole_nanoseconds(ended.round_trip);
  const SendReason reason = to_.reasons.of(ended);
  const Outcome outcome = public_outcome(ended.outcome);
  to_.host.result(client, {ended.token, outcome, round_trip, ended.tries, reason.text, reason.reason});
  if (!to_.observers.wants("sent")) return;
  to_.observers.tell("sent", {{"outcome", to_string(outcome)},
                              {"reason_code", to_string(reason.reason)},
                              {"reason", reason.text},
                              {"interrupt", ended.interrupt},
                              {"tries", ended.tries},
                              {"round_trip_us", static_cast<double>(round_trip.count()) / 1000}});
}

void EventRouter::handle(const core::PinPulled& pin) {
  pull(pin.factor, pin.source, to_.driver.clock().now().time_since_epoch().count());
}

void EventRouter::pull(std::uint8_t factor, std::uint8_t source, std::int64_t clock_ns) {
  const std::string done = to_.pins.pull(factor, source, clock_ns);
  log(pin_lines_.at(factor), done);  // the event, below, tells of each
  to_.observers.tell("pin", {{"factor", factor}, {"source", source}, {"what", done}});
}

void EventRouter::handle(const core::StateChanged& change) {
  const auto& membership = to_.driver.controller().membership();
  const std::string size =
      membership.ring_size() == 0 ? "" : fmt::format(", ring size {}", membership.ring_size());  // 0: not known yet
  log(state_lines_, fmt::format("{} -> {}{}", to_string(change.before), to_string(change.after), size));
  const auto line = membership.broken_line();
  nlohmann::json broken;
  if (line) broken = {{"before", std::uint8_t{line->before}}, {"behind", std::uint8_t{line->behind}}};
  to_.observers.tell("state", {{"before", to_string(change.before)},
                               {"after", to_string(change.after)},
                               {"broken_line", broken},
                               {"ring_size", membership.ring_size()}});
}

// ---- from the CPU and the watchdog --------------------------------------------------------

void EventRouter::on_cpu_changed() {
  const CpuStatus status = to_.cpu.status();
  std::string process = status.pid > 0 && !status.ending ? fmt::format(" (pid {}", status.pid) : "";
  if (!process.empty()) process += status.boots == 0 ? ")" : fmt::format(", boot {})", status.boots);
  spdlog::info("{}CPU {}{}", to_.log_prefix, to_string(status.state), process);
  to_.observers.tell("cpu", {{"state", to_string(status.state)}, {"pid", status.pid}, {"boots", status.boots}});
  to_.interrupts.on_cpu_changed(wire::NodeId{to_.node.id});
  if (status.boots != std::exchange(cpu_boots_, status.boots)) to_.faults.cpu_booted();
}

void EventRouter::on_finding(const watchdog::Watchdog::Finding& finding) {
  to_.observers.tell(
      "watchdog",
      {{"id", std::uint8_t{finding.node}}, {"verdict", to_string(finding.verdict)}, {"what", finding.what}});
}

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
  driver_.controller().apply(core::input::Send{request}, driver_.now());
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
