#include "node/cpu_process.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <csignal>
#include <cstring>

namespace limb_ring::runtime {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {
constexpr milliseconds kKilledTimeout{2000};
}

CpuProcess::CpuProcess(boost::asio::io_context& io, event_loop::NodeClock& clock, CpuOptions options, CpuEvents& events)
    : io_(io),
      clock_(clock),
      options_(std::move(options)),
      events_(events),
      child_(io, options_.by),
      commands_(io, options_.command_timeout, options_.by),
      back_off_(options_.back_off),
      boot_timer_(io),
      stop_timer_(io),
      restart_timer_(clock.timer([this] { restart_due(); })),
      end_timer_(clock.timer([this] { see_end(); })),
      silence_(clock, [this] { changed(); }) {}

CpuProcess::~CpuProcess() = default;

/// Calls `action` at `when`, unless the timer has been set again or we are gone by then.
template <class Action>
void CpuProcess::after(boost::asio::steady_timer& timer, Time when, Action action) {
  timer.expires_at(when);
  timer.async_wait([this, &timer, when, action, alive = std::weak_ptr(alive_)](const auto& error) {
    if (!error && !alive.expired() && timer.expiry() == when) (this->*action)();
  });
}

void CpuProcess::changed() {
  if (std::exchange(event_posted_, true)) return;
  boost::asio::post(io_, [this, alive = std::weak_ptr(alive_)] {
    if (alive.expired()) return;
    event_posted_ = false;
    events_.on_cpu_changed();
  });
}

// --- the child ---------------------------------------------------------------------------------

void CpuProcess::start() {
  if (options_.cpu.kind == config::CpuConfig::Kind::child) start_child();
}

process::SpawnRequest CpuProcess::request() const {
  process::SpawnRequest request;
  request.arguments = options_.cpu.command;
  request.environment = options_.environment;
  request.affinity = options_.affinity;
  request.output = options_.output;
  return request;
}

void CpuProcess::start_child() {
  last_ = {};
  const auto& command = options_.cpu.command;
  const std::string name = command.empty() ? "" : command.front();
  const std::string path = process::find_program(name, options_.program_folder);
  if (!path.empty()) return start_found(path);
  could_not_start(process::not_started(process::no_program(name, options_.program_folder)));
}

void CpuProcess::start_found(const std::string& path) {
  process::SpawnRequest child = request();
  child.path = path;
  child_.start(child, [this](const process::ExitStatus& status) { child_ended(status); });
  last_.started_at = clock_.now();
  watch_boot();
  changed();
}

milliseconds CpuProcess::ran() const {
  return std::chrono::duration_cast<milliseconds>(clock_.now() - last_.started_at);
}

void CpuProcess::could_not_start(const process::ExitStatus& why) {
  did_not_boot(why.text);
  restart_later(milliseconds(0));
}

void CpuProcess::watch_boot() {
  after(boot_timer_, steady_clock::now() + options_.boot_timeout, &CpuProcess::boot_timed_out);
}

void CpuProcess::boot_timed_out() {
  if (!child_.running() || last_.was_reset || attached_) return;
  last_.boot_failed = true;
  child_.signal_group(SIGKILL);
}

void CpuProcess::child_ended(const process::ExitStatus& status) {
  boot_timer_.cancel();
  const bool was_cpu = attached_ && attached_->process.ended();
  if (was_cpu && !on_virtual_ring()) let_go();
  if (stopping_) return stopped();
  if (last_.was_reset) return start_child();
  last_.end = status;
  if (!on_virtual_ring()) return see_end();
  if (was_cpu) return;                                        // detached() is to come
  const bool at_once = last_.has_booted || last_.fatal_sent;  // time stands until such a signal has taken effect
  see_end_at(at_once ? clock_.now() : std::max(clock_.now(), last_.started_at + options_.boots_for));
}

// On a virtual ring by its clock: what the end of the connection has changed, as sends that are cancelled, comes before
// it on the ring, also if the process has ended first.
void CpuProcess::see_end_at(Time when) { end_timer_->expires_at(when); }

void CpuProcess::see_end() {
  if (!last_.end || stopping_) return;
  const process::ExitStatus status = *std::exchange(last_.end, std::nullopt);
  if (last_.boot_failed)
    did_not_boot("did not attach to the host port within " + std::to_string(options_.boot_timeout.count()) + " ms");
  else if (!status.executed)
    did_not_boot(status.text);
  else
    return ended_by_itself(status);
  restart_later(ran());
}

void CpuProcess::ended_by_itself(const process::ExitStatus& status) {
  ++counts_.exits;
  counts_.last_exit = status.text;
  failed_ = !status.clean;
  spdlog::warn("{}CPU {} ended by itself: {}", options_.log_prefix, options_.cpu.command.front(), status.text);
  if (options_.cpu.restart_on_exit) restart_later(ran());
  changed();
}

void CpuProcess::did_not_boot(const std::string& why) {
  ++counts_.failed_boots;
  failed_ = true;
  if (counts_.last_exit != why) spdlog::error("{}CPU does not start: {}", options_.log_prefix, why);
  counts_.last_exit = why;
  changed();
}

void CpuProcess::restart_later(milliseconds ran) {
  counts_.restart_wait = back_off_.after(ran);
  restart_timer_->expires_at(clock_.now() + counts_.restart_wait);
}

void CpuProcess::restart_due() {
  if (!stopping_ && !child_.running()) start_child();
}

// --- on the host port --------------------------------------------------------------------------

bool CpuProcess::attached(pid_t pid, bool restarted_by_owner, milliseconds alive_period) {
  process::ProcessHandle process(pid, options_.by);
  const bool dying = (pid == killed_.pid() && !killed_.ended()) || (last_.is_being_killed() && child_.owns(pid));
  if (stopping_ || dying || process.ended()) return false;
  attached_ = Attached{std::move(process), restarted_by_owner};
  boot_timer_.cancel();
  last_.has_booted = true;
  failed_ = false;
  ++counts_.boots;
  silence_.begin(alive_period);
  changed();
  return true;
}

void CpuProcess::detached(pid_t pid) {
  if (!attached_ || attached_->process.pid() != pid) return;
  let_go();
  if (last_.end) return see_end_at(clock_.now());
  if (child_.running() && !stopping_) watch_boot();
  changed();
}

void CpuProcess::let_go() {
  attached_.reset();
  silence_.end();
}

void CpuProcess::spoke(Time now) {
  if (attached_ && silence_.spoke(now)) changed();
}

// --- actions -----------------------------------------------------------------------------------

CpuActionResult CpuProcess::reset(const std::string& reason) {
  if (stopping_) return {false, false, "the daemon is shutting down"};
  const bool child = options_.cpu.kind == config::CpuConfig::Kind::child;
  if (!child && !attached_) return {false, false, "no CPU is attached to this node, so there is nothing to reset"};
  ++counts_.resets;
  counts_.last_reset_reason = reason;
  const CpuActionResult killed = attached_ ? kill_attached() : CpuActionResult{};
  changed();
  return child ? reset_child() : killed;
}

CpuActionResult CpuProcess::reset_child() {
  const std::string was =
      child_.running() ? "killed pid " + std::to_string(child_.pid()) + ", " : "it was not running, ";
  back_off_.reset();
  restart_timer_->cancel();
  end_timer_->cancel();
  failed_ = false;
  last_.was_reset = child_.running();
  if (last_.was_reset)
    child_.signal_group(SIGKILL);
  else
    start_child();
  if (failed_) return {false, false, counts_.last_exit};
  return {true, true, was + "started again"};
}

CpuActionResult CpuProcess::kill_attached() {
  const bool killed = attached_->process.signal(SIGKILL);
  const bool comes_back = attached_->restarted_by_owner;
  const std::string number = std::to_string(attached_->process.pid());
  killed_ = std::move(attached_->process);
  let_go();
  if (!killed) return {false, false, "cannot kill pid " + number + ": it is gone or not ours"};
  if (comes_back) return {true, true, "killed pid " + number + ", its owner starts it again"};
  return {true, false,
          "killed pid " + number +
              ", and nobody starts it again: do so by hand, or "
              "have it connect with restarted_by_owner (roslaunch: respawn)"};
}

CpuActionResult CpuProcess::signal(int number) {
  const process::ProcessHandle child(attached_ ? -1 : child_.pid(), options_.by);
  const process::ProcessHandle& process = attached_ ? attached_->process : child;
  if (!process.signal(number)) return {false, false, "no CPU is there"};
  last_.fatal_sent = last_.fatal_sent || is_fatal(number);
  if (options_.on_signal) options_.on_signal(number);
  const std::string name = std::to_string(number) + " (" + ::strsignal(number) + ")";
  return {true, false, "sent signal " + name + " to pid " + std::to_string(process.pid())};
}

CpuActionResult CpuProcess::run(const std::vector<std::string>& command) {
  if (stopping_) return {false, false, "the daemon is shutting down"};
  const std::string refused = commands_.run(command, request());
  return {refused.empty(), false, refused.empty() ? "started " + command.front() : refused};
}

// --- the end -----------------------------------------------------------------------------------

void CpuProcess::stop(std::function<void()> done) {
  stopping_ = true;
  on_stopped_ = std::move(done);
  boot_timer_.cancel();
  restart_timer_->cancel();
  silence_.end();
  end_timer_->cancel();
  commands_.stop();
  if (!child_.running()) {
    boost::asio::post(io_, [this, alive = std::weak_ptr(alive_)] {
      if (!alive.expired()) stopped();
    });
    return;
  }
  child_.signal_group(SIGTERM);
  child_.signal_group(SIGCONT);  // a stopped one would not see it
  after(stop_timer_, steady_clock::now() + options_.stop_timeout, &CpuProcess::force_stop);
}

void CpuProcess::force_stop() {
  child_.signal_group(SIGKILL);
  // One that even SIGKILL does not end at once hangs in the kernel; we do not hang with it.
  after(stop_timer_, steady_clock::now() + kKilledTimeout, &CpuProcess::stopped);
}

void CpuProcess::stopped() {
  stop_timer_.cancel();
  if (const auto done = std::exchange(on_stopped_, nullptr)) done();
}

// --- what it looks like ------------------------------------------------------------------------

CpuKind CpuProcess::kind() const {
  switch (options_.cpu.kind) {
    case config::CpuConfig::Kind::child:
      return CpuKind::child;
    case config::CpuConfig::Kind::attached:
      return CpuKind::attached;
    case config::CpuConfig::Kind::none:
      break;
  }
  return attached_ ? CpuKind::attached : CpuKind::none;
}

wire::CpuState CpuProcess::state() const {
  if (attached_) return silence_.silent() ? wire::CpuState::silent : wire::CpuState::running;
  if (child_.running() || last_.end) return wire::CpuState::booting;
  if (kind() == CpuKind::none) return wire::CpuState::none;
  return failed_ ? wire::CpuState::failed : wire::CpuState::absent;
}

pid_t CpuProcess::pid() const { return attached_ ? attached_->process.pid() : child_.pid(); }

CpuStatus CpuProcess::status() const {
  CpuStatus status = counts_;
  status.kind = kind();
  status.state = state();
  status.pid = pid();
  status.unsettled =
      on_virtual_ring() && (child_.running() || last_.end) && last_.has_booted && !last_.was_reset && !attached_;
  status.ending = child_.running() && last_.is_being_killed();
  if (!attached_) return status;
  status.silent = silence_.silent_for();
  status.alive_period = silence_.alive_period();
  status.restarted_by_owner = attached_->restarted_by_owner;
  return status;
}

}  // namespace limb_ring::runtime
