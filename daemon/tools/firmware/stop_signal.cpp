#include "tools/firmware/stop_signal.h"

#include <csignal>
#include <cstdlib>

#include <unistd.h>

namespace limb_ring::firmware {
namespace {

volatile std::sig_atomic_t requested = 0;

void on_signal(int) { requested = 1; }

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
}

bool stop_requested() { return requested != 0; }

namespace {

void ignore_signals() {
  sigset_t all;
  sigfillset(&all);
  sigprocmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

void hang() {
  ignore_signals();
  for (;;) pause();
}

void loop_endlessly() {
  ignore_signals();
  for (volatile bool forever = true; forever;) {
  }
  std::abort();  // not reached
}

}  // namespace limb_ring::firmware
