#include "ros_bridge/respawn.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <stdexcept>

#include "io/back_off.h"
#include "io/child.h"
#include "io/signal_wait.h"

namespace limb_ring::bridge {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kWrongParameters = 2;

/// @return whether this process was asked to end while the child ran
bool wait_for(process::Child& child, const process::SignalWait& signals) {
  bool asked = false;
  while (!child.reap()) {
    const int signal = signals.next();
    if (!process::SignalWait::asks_to_end(signal)) continue;
    asked = true;
    child.signal(signal);
  }
  return asked;
}

/// @return true where the parent is asked to end meanwhile
bool wait_before_next(milliseconds wait, const process::SignalWait& signals) {
  const auto until = steady_clock::now() + wait;
  for (auto now = steady_clock::now(); now < until; now = steady_clock::now())
    if (signals.asked_to_end(std::chrono::ceil<milliseconds>(until - now))) return true;
  return false;
}

}  // namespace

int respawned(const std::function<int()>& program) {
  // Held back to the end of this process: one that comes after the child's end must not change our exit code.
  const process::SignalWait& signals = *new process::SignalWait;
  // It ends by exit(), as from main(): ROS ends in an exit handler.
  const auto work = [&]() -> int {
    signals.release();
    std::exit(program());
  };
  const pid_t starter = ::getppid();
  process::BackOff back_off({});
  for (;;) {
    const auto start = steady_clock::now();
    process::Child child(process::spawn_copy(work, SIGTERM), "the process");
    if (child.ended()) throw std::runtime_error(child.ended()->text);
    const bool asked = wait_for(child, signals);
    const process::ExitStatus& end = *child.ended();
    const int code = end.code.value_or(1);
    if (asked || code == kWrongParameters || ::getppid() != starter) return code;
    std::cerr << "the process ended with " << end.text << " and is started again" << std::endl;
    const auto ran = std::chrono::duration_cast<milliseconds>(steady_clock::now() - start);
    if (wait_before_next(back_off.after(ran), signals)) return code;
  }
}

}  // namespace limb_ring::bridge
