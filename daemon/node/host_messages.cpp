// What HostServer does with each message of a client.
#include <algorithm>
#include <utility>

#include "client/arguments.h"
#include "io/process_state.h"
#include "node/host_server.h"

namespace limb_ring::host {

using client::ClockKind;

namespace {

/// A CPU asks for a few packets at a time; one that asks for more gets this many.
constexpr unsigned kMaxCredit = 64;

bool sends(const client::ToDaemon& message) {
  return std::holds_alternative<client::SendRequest>(message) ||
         std::holds_alternative<client::InterruptRequest>(message) ||
         std::holds_alternative<client::PullRequest>(message);
}

/// It has an answer.
bool asks(const client::ToDaemon& message) {
  return sends(message) || std::holds_alternative<client::JsonRequest>(message);
}

bool changes_something(const client::ToDaemon& message, const HostHandler& handler) {
  const auto* request = std::get_if<client::JsonRequest>(&message);
  return request != nullptr ? handler.changes_something(*request) : sends(message);
}

}  // namespace

void HostServer::on_message(Session& session, const client::ToDaemon& message) {
  if (options_.turns != nullptr && !session.info().lockstep && changes_something(message, handler_))
    options_.turns->disturbed();
  const auto began = std::chrono::steady_clock::now();
  if (session.attached()) handler_.on_alive(session.info().id);
  if (asks(message)) session.asks();
  std::visit([&](const auto& kind) { on(session, kind); }, message);
  count_time(began);
}

void HostServer::count_time(std::chrono::steady_clock::time_point since) {
  if (std::exchange(turn_, loop_.turns()) != loop_.turns()) taken_ = {};
  taken_ += std::chrono::steady_clock::now() - since;
}

bool HostServer::has_asked_enough() const { return taken_ >= kTimePerTurn; }

/// If both are pending, the kernel may report a new CPU's greeting before the end of the old CPU's connection. And a
/// process that the old one has forked may have kept that open.
void HostServer::free_cpu_slots_of_the_dead() {
  for (const SessionPtr& cpu : {cpu_, booting_cpu_}) {
    if (!cpu || !(cpu->hung_up() || process::is_gone(cpu->info().pid))) continue;
    cpu->end("");
    retire(*cpu);
  }
  tell_detached();
}

std::optional<std::string> HostServer::objection(const client::Greeting& greeting, const ClientInfo& info) {
  const std::string node = whose();
  if (greeting.version != client::kHostPortVersion) {
    return node + " speaks version " + std::to_string(client::kHostPortVersion) +
           " of the host port, this client version " + std::to_string(greeting.version);
  }
  if (!greeting.ring.empty() && greeting.ring != options_.ring) {
    return node + " belongs to ring " + options_.ring + ", not to " + std::string(greeting.ring);
  }
  const SessionPtr& other = cpu_ ? cpu_ : booting_cpu_;
  if (greeting.role == Role::cpu && other) {
    return node + " has a CPU already: pid " + std::to_string(other->info().pid);
  }
  return handler_.on_attach(info);
}

std::size_t HostServer::attached_for_long() const {
  return static_cast<std::size_t>(std::count_if(sessions_.begin(), sessions_.end(), [](const auto& one) {
    const ClientInfo& info = one.second->info();
    return one.second->attached() && !info.asks_only && info.role != Role::cpu;
  }));
}

void HostServer::on(Session& session, const client::Greeting& greeting) {
  const bool has_kept_place = greeting.asks_only || greeting.role == Role::cpu;
  if (!has_kept_place && attached_for_long() >= options_.max_clients &&
      !make_room(session.info().pid, /*greeted=*/true)) {
    ++counters_.refused_full;
    return disconnect(session.info().id, full());
  }
  if (is_in_lockstep(greeting) && greeting.version == client::kHostPortVersion) return attach_later(session, greeting);
  if (attach(session, greeting)) session.put(welcome(options_.turns ? ClockKind::ring : ClockKind::machine));
}

/// Only a CPU is waited for: a tool that asks for it is told that it is not.
bool HostServer::is_in_lockstep(const client::Greeting& greeting) const {
  return options_.turns != nullptr && greeting.lockstep && greeting.role == Role::cpu;
}

client::Welcome HostServer::welcome(ClockKind clock) const {
  return {options_.id, options_.name, options_.ring, clock};
}

// A second one that greets meanwhile is refused as after the boot: the ring waits for one CPU of a node.
void HostServer::attach_later(Session& session, const client::Greeting& greeting) {
  free_cpu_slots_of_the_dead();
  if (booting_cpu_) return static_cast<void>(attach(session, greeting));
  booting_cpu_ = session.shared_from_this();
  session.greeted();
  session.put(welcome(ClockKind::lockstep));
  const auto when_booted = [this, alive = alive_, weak = session.weak_from_this(), greeting,
                            ring = std::string(greeting.ring)] {
    const SessionPtr booted = weak.lock();
    if (!*alive || !booted || !booted->open()) return;
    client::Greeting own = greeting;
    own.ring = ring;
    attach_now(booted, own);
  };
  handler_.on_greeted(session.info().pid);
  options_.turns->greeted(options_.id, when_booted);
}

void HostServer::attach_now(const SessionPtr& session, const client::Greeting& greeting) {
  booting_cpu_.reset();
  if (!attach(*session, greeting)) handler_.on_left(session->info().pid);
}

bool HostServer::attach(Session& session, const client::Greeting& greeting) {
  free_cpu_slots_of_the_dead();
  ClientInfo info = session.info();
  info.role = greeting.role;
  info.restarted_by_owner = greeting.restarted_by_owner;
  info.asks_only = greeting.asks_only;
  info.results_may_wait = greeting.results_may_wait;
  info.lockstep = is_in_lockstep(greeting);
  info.alive_period = greeting.alive_period;
  if (const auto reason = objection(greeting, info)) {
    ++counters_.refused;
    disconnect(info.id, *reason);
    return false;
  }
  if (!session.open()) return false;  // the handler has ended it
  session.attach(info, options_.turns);
  if (greeting.role == Role::cpu) cpu_ = session.shared_from_this();
  if (info.lockstep) options_.turns->joined(options_.id, session.shared_from_this());
  return true;
}

bool HostServer::rejected(Session& session, std::uint32_t token, const std::optional<client::Problem>& problem) {
  if (!problem) return false;
  ++counters_.rejected;
  session.is_told();
  session.put(Result{token, Outcome::rejected, std::chrono::nanoseconds{0}, 0, problem->text, problem->why});
  return true;
}

void HostServer::on(Session& session, const client::SendRequest& request) {
  const auto problem = client::send_problem(request.data.size, request.priority, request.channel);
  if (!rejected(session, request.token, problem)) handler_.on_send(session.info().id, request);
}

void HostServer::on(Session& session, const client::InterruptRequest& request) {
  const auto problem = client::interrupt_problem(request.factor);
  if (!rejected(session, request.token, problem)) handler_.on_interrupt(session.info().id, request);
}

void HostServer::on(Session& session, const client::PullRequest& request) {
  const auto problem = client::pull_problem(request.input);
  if (!rejected(session, request.token, problem)) handler_.on_pull(session.info().id, request);
}

void HostServer::on(Session& session, const client::JsonRequest& request) {
  handler_.on_request(session.info().id, request);
}

void HostServer::on(Session& session, const client::ObserveRequest& request) {
  session.observes();
  handler_.on_observe(session.info().id, request);
}

void HostServer::on(Session&, const client::Alive&) {}  // on_message() has told the handler

void HostServer::on(Session& session, const client::Waiting& waiting) { session.end_turn(waiting.until); }

void HostServer::on(Session& session, const client::Credit& credit) {
  if (&session != cpu_.get()) return;
  if (options_.turns != nullptr) options_.turns->credited(options_.id, credit.count);
  const bool had_none = session.credit == 0;
  session.credit = std::min(session.credit + credit.count, kMaxCredit);
  if (had_none && session.credit > 0) handler_.on_credit(session.info().id);
}

}  // namespace limb_ring::host
