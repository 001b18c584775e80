#pragma once

#include <chrono>

namespace limb_ring::firmware {

/// SIGTERM and SIGINT. They are blocked except while waiting, so none is missed between a check and a wait.
void catch_stop_signals();
bool stop_requested();
/// Waits until `fd` is readable, a stop is requested, or `timeout` is over.
void wait_readable(int fd, std::chrono::nanoseconds timeout);
/// Does nothing for ever, as a CPU that hangs. Only SIGKILL ends it.
[[noreturn]] void hang();

}  // namespace limb_ring::firmware
