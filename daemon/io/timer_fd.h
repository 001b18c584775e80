#pragma once

#include <sys/timerfd.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>

#include "io/throw_errno.h"

namespace limb_ring::event_loop {

/// @throw std::system_error
inline int make_timer() {
  const int timer = ::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
  if (timer < 0) process::throw_errno("cannot make a timer");
  return timer;
}

/// The timer runs out at `when` (0: never), then every `period` (0: only once). Setting it again forgets that it has
/// run out, so one without a period need not be read. @param flags TFD_TIMER_ABSTIME, or 0
inline void set_timer(int timer, int flags, std::chrono::nanoseconds when, std::chrono::nanoseconds period) {
  const auto spec_of = [](std::chrono::nanoseconds time) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    return timespec{time.count() / kSecond, time.count() % kSecond};
  };
  const itimerspec spec{spec_of(period), spec_of(when)};
  ::timerfd_settime(timer, flags, &spec, nullptr);
}

/// Reads a timer that has run out: one with a period goes on only then.
inline void tick_again(int timer) {
  std::uint64_t times;
  [[maybe_unused]] const auto got = ::read(timer, &times, sizeof times);
}

}  // namespace limb_ring::event_loop
