#include "virtual_host/lockstep.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>

#include "process/process_state.h"

namespace limb_ring::virtual_host {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

namespace {

/// So long they are heard before what else there is has its turn.
constexpr milliseconds kHearing{2};
/// Of real time, from the node's start: ROS nodes take some seconds.
constexpr std::chrono::seconds kAttachedWithin{30};

double seconds(core::Time time) { return std::chrono::duration<double>(time.time_since_epoch()).count(); }

}  // namespace

// The bridge is to be there from the start, since a controller is.
Lockstep::Lockstep(sim::VirtualRing& ring, const config::RingConfig& config) : ring_(ring), config_(config) {
  for (const config::NodeConfig& node : config.nodes) expect_bridge(node.id);
}

void Lockstep::expect_bridge(std::uint8_t node) {
  if (config_.bridge.lockstep && config_.find(node)->cpu.kind == config::CpuConfig::Kind::attached)
    boots_[node] = {ring_.now() + config_.virtual_clock.boot_time};
}

nanoseconds Lockstep::now() const { return std::chrono::floor<nanoseconds>(ring_.now().time_since_epoch()); }

// ---- who comes ------------------------------------------------------------------------------

void Lockstep::greeted(std::uint8_t node, std::function<void()> attach) {
  news_ = true;
  const auto boot = boots_.find(node);
  if (boot != boots_.end()) {
    boot->second.attach = std::move(attach);
    return;
  }
  disturbed_ = true;  // nobody knew when it would come
  attach();
}

/// It is started by others, and has not come.
bool Lockstep::is_late(std::uint8_t node, const Boot& boot) const {
  return config_.find(node)->cpu.kind == config::CpuConfig::Kind::attached &&
         steady_clock::now() - boot.since > kAttachedWithin;
}

bool Lockstep::attach_those_due() {
  for (auto it = boots_.begin(); it != boots_.end();) {
    const bool gone = !it->second.attach && !is_frozen(it->first) && is_late(it->first, it->second);
    if (gone)
      spdlog::warn("{}: bridge.lockstep: its CPU, the bridge, has not come within {} s; time goes on without it",
                   config_.find(it->first)->name, kAttachedWithin.count());
    it = gone ? boots_.erase(it) : std::next(it);
  }
  std::vector<std::function<void()>> due;
  for (const auto& [node, boot] : boots_) {
    if (boot.at > ring_.now() || is_frozen(node)) continue;
    if (!boot.attach) return false;
    due.push_back(boot.attach);
  }
  for (auto it = boots_.begin(); it != boots_.end();)
    it = it->second.at > ring_.now() || is_frozen(it->first) ? std::next(it) : boots_.erase(it);
  for (const auto& attach : due) attach();
  return true;
}

void Lockstep::joined(std::uint8_t node, const std::shared_ptr<host::Session>& session) {
  session->end_turn(nanoseconds{0});  // its first turn comes at once
  programs_[{node, session->info().id}] = {session, {}, false};
  news_ = true;
}

// One that is new boots; the one that was there before is ending.
void Lockstep::cpu_changed(std::uint8_t node, const runtime::CpuStatus& cpu) {
  const bool boots = cpu.kind == runtime::CpuKind::child && cpu.state == wire::CpuState::booting && cpu.pid > 0;
  if (!boots) {
    if (cpu.kind == runtime::CpuKind::child) boots_.erase(node);
  } else if (std::exchange(pids_[node], cpu.pid) != cpu.pid) {
    boots_[node] = {ring_.now() + config_.virtual_clock.boot_time};
  } else {
    boots_.emplace(node, Boot{ring_.now()});
  }
  news_ = true;
}

void Lockstep::node_died(std::uint8_t node) {
  boots_.erase(node);
  frozen_.erase(node);
  pids_.erase(node);
}

// One that has booted meanwhile, or was acting, has its time from now on.
void Lockstep::node_thawed(std::uint8_t node) {
  frozen_.erase(node);
  const auto boot = boots_.find(node);
  if (boot != boots_.end()) {
    boot->second.at = std::max(boot->second.at, ring_.now());
    boot->second.since = steady_clock::now();
  }
  for (auto& [key, program] : programs_)
    if (key.first == node) program.turn_since = steady_clock::now();
}

// ---- whose turn it is -----------------------------------------------------------------------

void Lockstep::forget_gone() {
  for (auto it = programs_.begin(); it != programs_.end();)
    it = it->second.session->open() ? std::next(it) : programs_.erase(it);
}

Lockstep::Entry* Lockstep::acting() {
  forget_gone();
  for (Entry& entry : programs_) {
    auto& [key, program] = entry;
    if (is_frozen(key.first)) continue;
    if (program.session->has_turn() && !program.stuck) return &entry;
    if (!program.session->has_turn() && std::exchange(program.stuck, false))
      spdlog::info("{}: its CPU goes on, at {:.9f} s", config_.find(key.first)->name, seconds(ring_.now()));
  }
  return nullptr;
}

void Lockstep::listen() {
  const Instant end = steady_clock::now() + kHearing;
  while (Entry* entry = acting())
    if (!hear(*entry) || steady_clock::now() >= end) return;
}

/// @return false where it says nothing yet
bool Lockstep::hear(Entry& entry) {
  auto& [key, program] = entry;
  const bool heard = program.session->listen();
  if (!program.session->open() || !program.session->has_turn()) return true;
  const bool stopped = !heard && process::is_stopped(program.session->info().pid);
  if (stopped || steady_clock::now() - program.turn_since >= patience_with(key.first)) is_stuck(key.first, program);
  return heard;
}

/// A bridge waits for its controller, with limits of its own.
milliseconds Lockstep::patience_with(std::uint8_t node) const {
  const milliseconds stall = config_.virtual_clock.stall;
  const bool bridge = config_.bridge.lockstep && config_.find(node)->cpu.kind == config::CpuConfig::Kind::attached;
  return bridge ? kAttachedWithin + 3 * stall : stall;
}

void Lockstep::is_stuck(std::uint8_t node, Program& program) {
  program.stuck = true;
  program.session->wait_no_more();
  const pid_t pid = program.session->info().pid;
  if (process::is_stopped(pid))
    return spdlog::warn("{}: its CPU, pid {}, is stopped, at {:.9f} s of the ring's time; the ring goes on without it",
                        config_.find(node)->name, pid, seconds(ring_.now()));
  somebody_was_stuck_ = true;
  spdlog::warn(
      "{}: its CPU ({}, pid {}) is stuck at {:.9f} s of the ring's time: it has not waited again for {} ms; the "
      "ring goes on without it",
      config_.find(node)->name, process::program_of(pid), pid, seconds(ring_.now()), patience_with(node).count());
}

bool Lockstep::give_turns() {
  std::optional<std::uint8_t> given;
  for (auto& [key, program] : programs_) {
    host::Session& session = *program.session;
    if (given == key.first || is_frozen(key.first) || !session.open() || session.has_turn()) continue;
    if (!session.has_news() && session.waits_until() > now()) continue;
    program.turn_since = steady_clock::now();
    session.begin_turn(now());
    given = key.first;
  }
  return given.has_value();
}

core::Time Lockstep::next_wake() const {
  nanoseconds earliest = nanoseconds::max();
  for (const auto& [key, program] : programs_)
    if (!program.session->has_turn() && !is_frozen(key.first))
      earliest = std::min(earliest, program.session->waits_until());
  return earliest == nanoseconds::max() ? core::kNever : core::Time{} + earliest;
}

core::Time Lockstep::held_at() const {
  core::Time earliest = core::kNever;
  for (const auto& [node, boot] : boots_)
    if (!is_frozen(node)) earliest = std::min(earliest, boot.at);
  return earliest;
}

std::string Lockstep::not_repeatable() const {
  std::string why;
  if (disturbed_) why = "a program that the clock does not wait for has come, or has sent something";
  if (somebody_was_stuck_) why += std::string(why.empty() ? "" : ", and ") + "a CPU was stuck";
  return why;
}

}  // namespace limb_ring::virtual_host
