#pragma once

namespace limb_ring::firmware {

/// Notes SIGTERM and SIGINT.
void catch_stop_signals();
bool stop_requested();
/// Does nothing for ever, as a CPU that hangs. Only SIGKILL ends it.
[[noreturn]] void hang();

}  // namespace limb_ring::firmware
