#include "node/lockstep.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <sstream>
#include <vector>

#include "io/process_state.h"
#include "node/cpu_process.h"

namespace limb_ring::virtual_host {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

namespace {

/// How long await_messages() goes on before the event loop has its turn, real time.
constexpr milliseconds kAwaiting{2};
/// So many turns in one instant has no program that waits for anything: it asks, or sends what is rejected, again and
/// again, or waits for a time that is over. Time would stand for ever.
constexpr unsigned kMostTurns = 10'000;
constexpr milliseconds kRest{1};  ///< of the ring's time
/// Real time between two looks at who sleeps while time waits for it; how much of it is too much; and how often that is
/// logged.
constexpr std::chrono::seconds kSleepLook{2}, kSleepTold{60};
constexpr double kMostSleep = 0.75;

double seconds(core::Time time) { return std::chrono::duration<double>(time.time_since_epoch()).count(); }

}  // namespace

Lockstep::Lockstep(sim::VirtualRing& ring, const config::RingConfig& config)
    : ring_(ring),
      config_(config),
      order_(config.virtual_clock.order),
      boots_(ring, config, [this](std::uint8_t node) { return frozen_.count(node) + hung_.count(node) != 0; }) {
  for (const config::NodeConfig& node : config.nodes) boots_.expect_bridge(node.id);
  if (config.virtual_clock.order != 0)
    spdlog::info("programs that act in one instant do so in an order drawn by seed {}", config.virtual_clock.order);
}

nanoseconds Lockstep::now() const { return std::chrono::floor<nanoseconds>(ring_.now().time_since_epoch()); }

// ---- who comes ------------------------------------------------------------------------------

void Lockstep::greeted(std::uint8_t node, std::function<void()> attach) {
  news_ = true;
  if (boots_.greeted(node, attach)) return;
  disturbed_ = true;  // nobody knew when it would come
  attach();
}

void Lockstep::left(std::uint8_t node) {
  boots_.left(node);
  news_ = true;
}

void Lockstep::joined(std::uint8_t node, const std::shared_ptr<host::Session>& session) {
  session->end_turn(nanoseconds{0});  // its first turn comes at once
  programs_[{node, session->info().id}] = {session, {}};
  news_ = true;
}

void Lockstep::cpu_changed(std::uint8_t node, const runtime::CpuStatus& cpu) {
  const bool is_new = boots_.changed(node, cpu);
  if (is_new || cpu.ending || cpu.pid <= 0) hung_.erase(node);
  news_ = true;
}

void Lockstep::cpu_signalled(std::uint8_t node, int number) {
  if (number == SIGSTOP) hung_.insert(node);
  if (number == SIGCONT && hung_.erase(node) != 0) goes_on(node);
  if (runtime::is_fatal(number)) {
    boots_.ends(node);
    for (auto& [key, program] : programs_)
      if (key.first == node && program.session->info().role == Role::cpu) program.dies = true;
  }
  news_ = true;
}

void Lockstep::node_died(std::uint8_t node) {
  boots_.forget(node);
  frozen_.erase(node);
  hung_.erase(node);
}

void Lockstep::node_thawed(std::uint8_t node) {
  frozen_.erase(node);
  goes_on(node);
}

// Time limits of a program that booted or acted meanwhile start again now.
void Lockstep::goes_on(std::uint8_t node) {
  boots_.goes_on(node);
  for (auto& [key, program] : programs_)
    if (key.first == node) {
      program.turn_since = steady_clock::now();
      program.stuck = false;
    }
}

// ---- whose turn it is -----------------------------------------------------------------------

void Lockstep::forget_gone() {
  for (auto it = programs_.begin(); it != programs_.end();) {
    const host::Session& session = *it->second.session;
    if (session.ended_by_client() && !session.turn().is_on() && !it->second.dies) left_ = true;
    it = session.open() ? std::next(it) : programs_.erase(it);
  }
}

/// It has no turns, and time does not wait for it.
bool Lockstep::is_away(const Entry& entry) const {
  const auto& [key, program] = entry;
  if (frozen_.count(key.first) != 0) return true;
  if (program.session->info().role != Role::cpu) return false;
  return hung_.count(key.first) != 0 || boots_.is_ending(key.first);
}

Lockstep::Entry* Lockstep::acting() {
  forget_gone();
  for (Entry& entry : programs_) {
    auto& [key, program] = entry;
    if (is_away(entry)) continue;
    if (program.session->turn().is_on() && !program.stuck) return &entry;
    if (!program.session->turn().is_on() && std::exchange(program.stuck, false))
      spdlog::info("{}: its CPU goes on, at {:.9f} s", config_.find(key.first)->name, seconds(ring_.now()));
  }
  return nullptr;
}

void Lockstep::await_messages() {
  const Instant end = steady_clock::now() + kAwaiting;
  look_who_sleeps();
  while (Entry* entry = acting())
    if (!await_message_of(*entry) || steady_clock::now() >= end) return;
}

/// @return false if it says nothing yet
bool Lockstep::await_message_of(Entry& entry) {
  auto& [key, program] = entry;
  const Instant since = steady_clock::now();
  const bool heard = program.session->await_message();
  program.waited_for += steady_clock::now() - since;
  if (!program.session->open() || !program.session->turn().is_on()) return true;
  const bool stopped = !heard && process::is_stopped(program.session->info().pid);
  if (stopped || steady_clock::now() - program.turn_since >= patience_with(key.first)) gets_stuck(key.first, program);
  return heard;
}

/// A bridge waits for its controller, with limits of its own.
milliseconds Lockstep::patience_with(std::uint8_t node) const {
  const milliseconds stall = config_.virtual_clock.stall;
  return boots_.is_bridge(node) ? Boots::kAttachedWithin + 3 * stall : stall;
}

bool Lockstep::is_stuck(std::uint8_t node) const {
  const auto stuck = [node](const Entry& entry) { return entry.first.first == node && entry.second.stuck; };
  return hung_.count(node) != 0 || std::any_of(programs_.begin(), programs_.end(), stuck);
}

void Lockstep::gets_stuck(std::uint8_t node, Program& program) {
  program.stuck = true;
  program.session->wait_no_more();
  const pid_t pid = program.session->info().pid;
  left_ = left_ || process::is_stopped(pid);
  if (process::is_stopped(pid))
    return spdlog::warn(
        "{}: its CPU, pid {}, was stopped by a signal at {:.9f} s of the ring's time; the ring goes on without it",
        config_.find(node)->name, pid, seconds(ring_.now()));
  somebody_was_stuck_ = true;
  spdlog::warn(
      "{}: its CPU ({}, pid {}) is stuck at {:.9f} s of the ring's time: it has not waited again for {:g} s; the "
      "ring goes on without it",
      config_.find(node)->name, process::program_of(pid), pid, seconds(ring_.now()),
      std::chrono::duration<double>(patience_with(node)).count());
  on_stuck(node, process::program_of(pid), false);
}

/// Time stands for whoever computes, too; but a sleep in its loop is seen nowhere else: the ring just goes slowly.
void Lockstep::look_who_sleeps() {
  const nanoseconds window = steady_clock::now() - looked_;
  if (window < kSleepLook) return;
  looked_ += window;
  for (auto& [key, program] : programs_) judge_sleep(key.first, program, window);
}

void Lockstep::judge_sleep(std::uint8_t node, Program& program, nanoseconds window) {
  const nanoseconds waited_for = std::exchange(program.waited_for, nanoseconds{0});
  const host::ClientInfo& client = program.session->info();
  const auto not_asleep = process::time_not_asleep(client.pid), before = std::exchange(program.not_asleep, not_asleep);
  program.holds_time.clear();
  // A bridge waits for its controllers, and says so itself.
  if (!not_asleep || !before || client.role != Role::cpu || boots_.is_bridge(node)) return;
  const double slept = std::chrono::duration<double>(waited_for - (*not_asleep - *before)) / window;
  if (slept < kMostSleep) return;
  std::ostringstream text;
  text << "its CPU (" << process::program_of(client.pid) << ", pid " << client.pid
       << ") holds the ring's time: it slept "
       << "for " << std::lround(100 * slept) << " % of the last "
       << std::lround(std::chrono::duration<double>(window).count())
       << " s, while time waited for it. It should wait by receive() or sleep_until() of its port, which let time pass";
  program.holds_time = text.str();
  if (program.told && steady_clock::now() - *program.told < kSleepTold) return;
  program.told = steady_clock::now();
  spdlog::warn("{}: {}", config_.find(node)->name, program.holds_time);
}

std::string Lockstep::holds_time(std::uint8_t node) const {
  for (const auto& [key, program] : programs_)
    if (key.first == node && !program.holds_time.empty()) return program.holds_time;
  return "";
}

nanoseconds Lockstep::next_turn(const Program& program) const {
  const nanoseconds wanted = program.session->turn().has_news() ? now() : program.session->turn().next();
  return program.restless ? std::max(wanted, program.turn_at + kRest) : wanted;
}

void Lockstep::begin_turn(std::uint8_t node, Program& program) {
  if (now() > program.turn_at + kRest) program.restless = false;  // it has waited by itself
  if (std::exchange(program.turn_at, now()) != now()) program.turns = 0;
  if (++program.turns > kMostTurns && !program.restless) gets_restless(node, program);
  program.turn_since = steady_clock::now();
  program.session->begin_turn(now());
}

void Lockstep::gets_restless(std::uint8_t node, Program& program) {
  program.restless = true;
  const std::string name = process::program_of(program.session->info().pid);
  spdlog::warn(
      "{}: its CPU ({}, pid {}) lets no time pass at {:.9f} s of the ring's time: it had {} turns in this instant. It "
      "asks again and again, sends again and again what is rejected, or waits for a time that is over. From now on it "
      "has a turn every {:g} s",
      config_.find(node)->name, name, program.session->info().pid, seconds(ring_.now()), kMostTurns,
      std::chrono::duration<double>(kRest).count());
  on_stuck(node, name, true);
}

void Lockstep::find_due() {
  due_.clear();
  std::optional<std::uint8_t> found;
  for (Entry& entry : programs_) {
    auto& [key, program] = entry;
    const host::Session& session = *program.session;
    if (found == key.first || is_away(entry) || !session.open() || session.turn().is_on()) continue;
    if (next_turn(program) > now()) continue;
    due_.push_back(&entry);
    found = key.first;
  }
}

// Those that have no turn yet are still due when it is over.
bool Lockstep::give_turns() {
  find_due();
  if (config_.virtual_clock.order != 0 && due_.size() > 1) due_ = {due_[order_() % due_.size()]};
  for (Entry* entry : due_) begin_turn(entry->first.first, entry->second);
  return !due_.empty();
}

core::Time Lockstep::next_wake() const {
  nanoseconds earliest = nanoseconds::max();
  for (const Entry& entry : programs_) {
    const Program& program = entry.second;
    if (!program.session->turn().is_on() && !is_away(entry)) earliest = std::min(earliest, next_turn(program));
  }
  return earliest == nanoseconds::max() ? core::kNever : core::Time{} + earliest;
}

std::string Lockstep::not_repeatable() const {
  std::string why;
  const auto add = [&why](bool holds, const char* what) {
    if (holds) why += std::string(why.empty() ? "" : ", and ") + what;
  };
  add(disturbed_, "a program that the clock does not wait for has come, or has changed something");
  add(somebody_was_stuck_, "a CPU was stuck");
  add(left_, "a CPU ended or was stopped while it waited");
  return why;
}

namespace {

/// Real time: how long a process may take to end after it was killed, or was sent a signal that it may catch.
constexpr std::chrono::seconds kEndsWithin{10};

}  // namespace

Boots::Boots(const sim::VirtualRing& ring, const config::RingConfig& config, IsAway is_away)
    : ring_(ring), config_(config), is_away_(std::move(is_away)) {}

/// When a CPU that begins to boot now has booted. Rounded to ns, like the clock of its node.
core::Time Boots::boot_end() const {
  const auto now = std::chrono::floor<nanoseconds>(ring_.now().time_since_epoch());
  return core::Time{} + now + config_.virtual_clock.boot_time;
}

// The bridge has to be there from the start, because a robot's controller is.
void Boots::expect_bridge(std::uint8_t node) {
  if (is_bridge(node)) boots_[node] = {boot_end()};
}

bool Boots::is_bridge(std::uint8_t node) const {
  const config::NodeConfig& config = *config_.find(node);
  return !config_.bridge.lockstep.empty() && config.cpu.kind == config::CpuConfig::Kind::attached &&
         config.library.empty();
}

// ---- who comes ------------------------------------------------------------------------------

bool Boots::greeted(std::uint8_t node, const std::function<void()>& attach) {
  const auto boot = boots_.find(node);
  if (boot == boots_.end()) return false;
  if (boot->second.ends)
    attach();  // the attempt is refused
  else
    boot->second.attach = attach;
  return true;
}

void Boots::left(std::uint8_t node) {
  const auto boot = boots_.find(node);
  if (boot == boots_.end()) return;
  boot->second.attach = nullptr;
  boot->second.since = steady_clock::now();
}

// A new process is booting; cpu.ending means that the previous one is ending.
bool Boots::changed(std::uint8_t node, const runtime::CpuStatus& cpu) {
  const bool child = cpu.kind == runtime::CpuKind::child;
  const bool boots = child && cpu.state == wire::CpuState::booting && cpu.pid > 0;
  const bool was_ending = is_ending(node);
  if (cpu.ending) {
    ends(node);
  } else if (!boots) {
    if (was_ending ? cpu.pid <= 0 : child) drop(node);
  } else if (std::exchange(pids_[node], cpu.pid) != cpu.pid) {
    boots_[node] = {boot_end()};
    return true;
  } else {
    boots_.emplace(node, Boot{ring_.now()});
  }
  return false;
}

// Who has greeted in place of the child that is gone would wait for ever. If it was the child, it is refused.
void Boots::drop(std::uint8_t node) {
  const auto dropped = boots_.extract(node);
  if (!dropped.empty() && dropped.mapped().attach) dropped.mapped().attach();
}

void Boots::ends(std::uint8_t node) { boots_[node] = {ring_.now(), true}; }

bool Boots::is_ending(std::uint8_t node) const {
  const auto boot = boots_.find(node);
  return boot != boots_.end() && boot->second.ends;
}

void Boots::forget(std::uint8_t node) {
  boots_.erase(node);
  pids_.erase(node);
}

void Boots::goes_on(std::uint8_t node) {
  const auto boot = boots_.find(node);
  if (boot == boots_.end()) return;
  boot->second.at = std::max(boot->second.at, ring_.now());
  boot->second.since = steady_clock::now();
}

// ---- who is waited for ----------------------------------------------------------------------

core::Time Boots::held_at() const {
  core::Time earliest = core::kNever;
  for (const auto& [node, boot] : boots_)
    if (!is_away_(node)) earliest = std::min(earliest, boot.at);
  return earliest;
}

bool Boots::attach_those_due() {
  give_up_late_ones();
  const auto is_due = [this](std::uint8_t node, const Boot& boot) { return boot.at <= ring_.now() && !is_away_(node); };
  std::vector<std::function<void()>> due;
  for (const auto& [node, boot] : boots_) {
    if (!is_due(node, boot)) continue;
    if (!boot.attach) return false;
    due.push_back(boot.attach);
  }
  for (auto it = boots_.begin(); it != boots_.end();)
    it = is_due(it->first, it->second) ? boots_.erase(it) : std::next(it);
  for (const auto& attach : due) attach();
  return true;
}

void Boots::give_up_late_ones() {
  for (auto it = boots_.begin(); it != boots_.end();) {
    const bool late = is_late(it->first, it->second);
    if (late) give_up(it->first, it->second);
    it = late ? boots_.erase(it) : std::next(it);
  }
}

/// True if a CPU that others start has not come in time, or a process that was to end has not.
bool Boots::is_late(std::uint8_t node, const Boot& boot) const {
  const bool by_others = config_.find(node)->cpu.kind == config::CpuConfig::Kind::attached;
  if (boot.attach || is_away_(node) || !(boot.ends || by_others)) return false;
  return steady_clock::now() - boot.since > (boot.ends ? kEndsWithin : kAttachedWithin);
}

void Boots::give_up(std::uint8_t node, const Boot& boot) const {
  const std::string& name = config_.find(node)->name;
  if (boot.ends)
    spdlog::warn("{}: its CPU has not ended within {} s, as it was asked to; time goes on", name, kEndsWithin.count());
  else
    spdlog::warn("{}: bridge.lockstep: the bridge has not connected as its CPU within {} s; time goes on without it",
                 name, kAttachedWithin.count());
}

}  // namespace limb_ring::virtual_host
