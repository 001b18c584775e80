#pragma once

namespace limb_ring::firmware {

/// Notes SIGTERM and SIGINT.
void catch_stop_signals();
bool stop_requested();
/// Does nothing for ever, as a CPU that hangs. Only SIGKILL ends it.
[[noreturn]] void hang();
/// Goes round and round, as a program with a bug. Only SIGKILL ends it.
[[noreturn]] void loop_endlessly();

}  // namespace limb_ring::firmware
