#include "node/faults.h"

#include <algorithm>
#include <csignal>
#include <set>

#include "io/process_state.h"
#include "node/realtime.h"
#include "node/send_reason.h"
#include "node/session.h"

namespace limb_ring::runtime {

using fault::Fault;
using fault::LineFaults;
using fault::ToCpu;

namespace {

/// How long to wait until a mended line is connected again. If no node answers, the line is down for other reasons,
/// so the wait is bounded.
constexpr std::chrono::milliseconds kLinePatience{2000};

double seconds(std::chrono::nanoseconds time) { return std::chrono::duration<double>(time).count(); }

ToCpu to_cpu(const Fault& fault) { return fault::word_of(fault.name).to_cpu; }

void nobody(const std::string&) {}

}  // namespace

// ---- beginning ------------------------------------------------------------------------------

void Faults::begin(const Fault& fault, const Begun& begun) {
  drop_ended(driver_.now());
  if (fault::word_of(fault.name).of == fault::Of::line)
    begin_line(fault, begun);
  else
    begin_cpu(fault, begun);
}

Faults::Id Faults::add(const Fault& fault) {
  const Id id = ++last_id_;
  active_.try_emplace(id, fault, driver_.now());
  return id;
}

void Faults::begin_line(const Fault& fault, const Begun& begun) {
  LineBreaker& on = breaker_of(fault);
  const LineFaults::Id line = on.begin(fault, driver_.now());
  if (line == 0) {  // mended
    drop_ended(driver_.now());
    return wait_for(on, [begun](const std::string& problem) { begun(0, problem); });
  }
  const Id id = add(fault);
  active_.at(id).on = &on;
  active_.at(id).line = line;
  begun(id, "");
}

// Its duration counts from now, although a process stops a little later.
void Faults::begin_cpu(const Fault& fault, const Begun& begun) {
  const fault::Word& word = fault::word_of(fault.name);
  if (word.to_cpu == ToCpu::cure) forget_cpu_faults();
  if (word.ended_by == 0) return cpu_.begin(fault, [begun](const std::string& problem) { begun(0, problem); });
  const Id id = add(fault);
  end_later(id);
  cpu_.begin(fault, [this, id, begun](const std::string& problem) {
    const bool holds = problem.empty();
    if (!holds && active_.erase(id) != 0 && id == last_id_) --last_id_;
    begun(holds ? id : 0, problem);
  });
}

void Faults::end_later(Id id) {
  Active& active = active_.at(id);
  if (active.fault.lasts.count() == 0) return;
  active.end = driver_.clock().timer([this, id] { remove(id, nobody); });
  active.end->expires_at(driver_.clock().now() + active.fault.lasts);
}

// ---- the end --------------------------------------------------------------------------------

bool Faults::remove(Id id, const Done& done) {
  drop_ended(driver_.now());
  const auto found = active_.find(id);
  if (found == active_.end()) return false;
  LineBreaker* on = found->second.on;
  const LineFaults::Id line = found->second.line;
  const ToCpu what = to_cpu(found->second.fault);
  active_.erase(found);
  if (on == nullptr) {
    mend(what, done);
  } else {
    on->remove(line, driver_.now());
    wait_for(*on, done);
  }
  return true;
}

void Faults::clear(const Done& done) {
  active_.clear();
  LineBreaker& first = driver_.breaker(core::Line::first);
  LineBreaker* second = driver_.has_second_line() ? &driver_.breaker(core::Line::second) : nullptr;
  first.clear(driver_.now());
  if (second != nullptr) second->clear(driver_.now());
  cpu_.end(ToCpu::cure, [this, &first, second, done](const std::string& problem) {
    if (!problem.empty()) return done(problem);
    if (second == nullptr) return wait_for(first, done);
    wait_for(first, [this, second, done](const std::string&) { wait_for(*second, done); });
  });
}

// Mends nothing while another fault of the same kind is still active.
void Faults::mend(ToCpu what, const Done& done) {
  const auto holds = [what](const auto& entry) { return to_cpu(entry.second.fault) == what; };
  if (std::any_of(active_.begin(), active_.end(), holds)) return done("");
  cpu_.end(what, done);
}

void Faults::stop() {
  const auto hangs = [](const auto& entry) { return to_cpu(entry.second.fault) == ToCpu::stop; };
  if (std::any_of(active_.begin(), active_.end(), hangs)) cpu_.end(ToCpu::stop, nobody);
  active_.clear();
}

bool Faults::silence_cpu() const {
  const auto silences = [](const auto& entry) { return fault::word_of(entry.second.fault.name).silences; };
  return std::any_of(active_.begin(), active_.end(), silences);
}

void Faults::forget_cpu_faults() {
  for (auto it = active_.begin(); it != active_.end();)
    it = it->second.on == nullptr ? active_.erase(it) : std::next(it);
}

void Faults::cpu_booted() {
  forget_cpu_faults();
  cpu_.free_socket();
}

LineBreaker& Faults::breaker_of(const Fault& fault) {
  return driver_.breaker(fault.second_line ? core::Line::second : core::Line::first);
}

void Faults::wait_for(const LineBreaker& line, const Done& done) {
  wait_until(
      io_, alive_, [&line] { return line.mended(); }, kLinePatience, [done](bool) { done(""); });
}

/// Those that have ended by themselves, and a hang that somebody else has ended.
void Faults::drop_ended(core::Time now) {
  const OfLines there = of_lines(now);
  for (auto it = active_.begin(); it != active_.end();) {
    const Active& active = it->second;
    const bool ended = active.on != nullptr ? there.count({active.on, active.line}) == 0
                                            : to_cpu(active.fault) == ToCpu::stop && !cpu_.hangs();
    it = ended ? active_.erase(it) : std::next(it);
  }
}

// ---- what there is --------------------------------------------------------------------------

Faults::OfLines Faults::of_lines(core::Time now) const {
  std::set<LineBreaker*> lines;
  for (const auto& [id, active] : active_)
    if (active.on != nullptr) lines.insert(active.on);
  OfLines all;
  for (LineBreaker* line : lines)
    for (const LineFaults::Listed& one : line->list(now)) all.emplace(std::pair(line, one.id), one);
  return all;
}

std::vector<status::Fault> Faults::list() {
  const core::Time now = driver_.now();  // of all that follows: none may end in between
  drop_ended(now);
  const OfLines there = of_lines(now);
  std::vector<status::Fault> all;
  for (const auto& [id, active] : active_) {
    const Fault& fault = active.fault;
    const auto found = there.find({active.on, active.line});
    const LineFaults::Listed* of_line = found == there.end() ? nullptr : &found->second;
    const auto age = core::whole_nanoseconds(now - active.since);
    status::Fault& row = all.emplace_back();
    row.id.text = std::to_string(id);
    row.name = fault::word_of(fault.name).word;
    row.fault = fault::to_words(fault, nodes_);
    row.age_s = seconds(age);
    row.waits = of_line && of_line->waits;
    row.hits = of_line ? of_line->hits : cpu_.hits(to_cpu(fault));
    if (fault.packets != 0) row.packets_left = fault.packets - of_line->hits;
    if (fault.lasts.count() != 0 && fault.after_packets == 0)
      row.seconds_left = std::max(0.0, seconds(fault.after + fault.lasts - age));
  }
  return all;
}

namespace {

/// Signals take effect in an instant.
constexpr std::chrono::milliseconds kPatience{10'000};
/// What a reset may take beside the boot: the old process has to go, and an owner to start the new one.
constexpr std::chrono::milliseconds kUntilStarted{20'000};

}  // namespace

void CpuFaults::begin(const Fault& fault, const Done& done) {
  switch (to_cpu(fault)) {
    case ToCpu::stop:
      return hang(done);
    case ToCpu::restart:
      return reset(done);
    case ToCpu::crash:
      return crash(done);
    case ToCpu::cure:
      return end(ToCpu::cure, done);
    case ToCpu::read_slowly:
      fault.every.count() == 0 ? cpu_.read_throttle().not_at_all() : cpu_.read_throttle().one_per(fault.every);
      break;
    case ToCpu::babble:
      babbling_.start(fault.every);
      break;
    case ToCpu::mute:
      cpu_.send_gate().shut();
      break;
    case ToCpu::nothing:
      break;
  }
  done("");
}

void CpuFaults::end(ToCpu what, const Done& done) {
  switch (what) {
    case ToCpu::cure:
      free_socket();
      return wake(done);
    case ToCpu::stop:
      return wake(done);
    case ToCpu::read_slowly:
      read_on();
      break;
    case ToCpu::babble:
      babbling_.stop();
      break;
    case ToCpu::mute:
      cpu_.send_gate().open();
      break;
    case ToCpu::restart:
    case ToCpu::crash:
    case ToCpu::nothing:
      break;
  }
  done("");
}

void CpuFaults::free_socket() {
  babbling_.stop();
  cpu_.send_gate().open();
  read_on();
}

std::uint64_t CpuFaults::hits(ToCpu what) const {
  if (what == ToCpu::mute) return cpu_.send_gate().discarded();
  return what == ToCpu::babble ? babbling_.sent() : 1;
}

void CpuFaults::wait(std::function<bool()> condition, const std::string& otherwise, const Done& done) {
  wait_until(io_, alive_, std::move(condition), kPatience, [otherwise, done](bool met) { done(met ? "" : otherwise); });
}

void CpuFaults::hang(const Done& done) {
  const pid_t pid = cpu_.status().pid;
  const CpuActionResult sent = cpu_.signal(SIGSTOP);
  if (!sent.done) return done(sent.message);
  stopping_ = pid;
  const auto stopped = [this, pid] {
    if (process::is_stopped(pid) || process::is_gone(pid)) stopping_ = -1;
    return stopping_ != pid;  // also if wake() was called meanwhile
  };
  wait(stopped, "pid " + std::to_string(pid) + " does not stop", done);
}

// SIGCONT follows because a stopped process acts on a signal only when it continues.
void CpuFaults::crash(const Done& done) {
  const pid_t pid = cpu_.status().pid;
  const CpuActionResult sent = cpu_.signal(SIGSEGV);
  if (!sent.done) return done(sent.message);
  cpu_.signal(SIGCONT);
  wait([pid] { return process::is_gone(pid); }, "pid " + std::to_string(pid) + " lives on: it catches SIGSEGV", done);
}

void CpuFaults::reset(const Done& done) {
  const CpuStatus before = cpu_.status();
  if (before.state == wire::CpuState::none) return done("no CPU is there");
  const CpuActionResult report = cpu_.reset("fault");
  if (!report.done) return done(report.message);
  if (!report.comes_back) return done("");
  const auto has_booted = [this, before] { return cpu_.status().boots > before.boots; };
  const auto is_over = [this, has_booted, before] {
    return has_booted() || cpu_.status().failed_boots > before.failed_boots;
  };
  const auto patience = cpu_boot_ + kUntilStarted;
  wait_until(io_, alive_, is_over, patience, [this, has_booted, patience, done](bool in_time) {
    if (has_booted()) return done("");
    done("the CPU has not booted again" +
         (in_time ? ": " + cpu_.status().last_exit : " within " + std::to_string(patience.count()) + " ms"));
  });
}

void CpuFaults::wake(const Done& done) {
  const pid_t pid = cpu_.status().pid;
  if (!hangs()) return done("");
  stopping_ = -1;
  cpu_.signal(SIGCONT);
  wait([pid] { return !process::is_stopped(pid); },
       "pid " + std::to_string(pid) + " does not go on (does a debugger hold it?)", done);
}

void CpuFaults::read_on() {
  cpu_.read_throttle().as_fast_as_it_can();
  cpu_.hand_over();
  driver_.pump();
}

bool CpuFaults::hangs() const {
  const pid_t pid = cpu_.status().pid;
  return pid > 0 && (pid == stopping_ || process::is_stopped(pid));
}

namespace {

constexpr core::Owner kBabblingOwner = SendOwner::of(SendOwner::Kind::babbling_cpu).to_core();

}  // namespace

void BabblingCpu::start(std::chrono::nanoseconds period) {
  stop();
  period_ = period;
  on_ = true;
  first_token_ = next_token_;
  sent_ = 0;
  // One goes onto the ring, the others fill the queue, and the last is rejected: the queue is full from the start.
  const unsigned at_once = period.count() == 0 ? driver_.controller().settings().send_queue + 2 : 1;
  for (unsigned i = 0; i < at_once; ++i) send();
  driver_.pump();
}

void BabblingCpu::stop() {
  if (!on_) return;
  on_ = false;
  next_->cancel();
  driver_.controller().apply(core::input::Cancel{kBabblingOwner}, driver_.now());
  driver_.pump();
}

void BabblingCpu::send() {
  wire::store_u32(data_.data(), next_token_);  // no two alike
  core::SendRequest request;                   // of the highest priority, to all
  request.owner = kBabblingOwner;
  request.token = next_token_++;
  request.destination = wire::kBroadcast;
  request.data = {data_.data(), data_.size()};
  driver_.controller().apply(core::input::Send{request}, driver_.now());
}

void BabblingCpu::send_next() {
  if (!on_) return;
  send();
  driver_.pump();
}

void BabblingCpu::on_ended(const core::SendEnded& ended) {
  if (!on_ || ended.token - first_token_ >= next_token_ - first_token_) return;  // of an earlier run
  ++sent_;
  const auto pause = pause_after(ended.outcome, period_);
  if (pause.count() > 0) return next_->expires_at(driver_.clock().now() + pause);
  send();
}

}  // namespace limb_ring::runtime
