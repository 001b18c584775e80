#include "node/cpu_faults.h"

#include <csignal>

#include "io/process_state.h"
#include "node/wait_until.h"

namespace limb_ring::runtime {

namespace {

/// Signals take effect in an instant.
constexpr std::chrono::milliseconds kPatience{10'000};
/// What a reset may take beside the boot: the old process has to go, and an owner to start the new one.
constexpr std::chrono::milliseconds kUntilStarted{5'000};

}  // namespace

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

}  // namespace limb_ring::runtime
