#include "firmware/stop_signal.h"

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <ctime>

#include <poll.h>
#include <unistd.h>

namespace limb_ring::firmware {
namespace {

volatile std::sig_atomic_t requested = 0;
sigset_t mask_while_waiting;

void on_signal(int) { requested = 1; }

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigset_t stops;
  sigemptyset(&stops);
  for (int signal : {SIGTERM, SIGINT}) {
    sigaddset(&stops, signal);
    sigaction(signal, &action, nullptr);
  }
  sigprocmask(SIG_BLOCK, &stops, &mask_while_waiting);
  for (int signal : {SIGTERM, SIGINT}) sigdelset(&mask_while_waiting, signal);
}

bool stop_requested() { return requested != 0; }

void wait_readable(int fd, std::chrono::nanoseconds timeout) {
  const auto left = std::max<std::int64_t>(timeout.count(), 0);
  constexpr std::int64_t kSecond = 1'000'000'000;
  const timespec span{static_cast<time_t>(left / kSecond), static_cast<long>(left % kSecond)};
  pollfd readable{fd, POLLIN, 0};
  ppoll(&readable, 1, &span, &mask_while_waiting);
}

void hang() {
  for (;;) pause();
}

}  // namespace limb_ring::firmware
