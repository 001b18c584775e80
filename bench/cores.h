#pragma once

#include <sched.h>

#include <optional>

#include "bench/setup.h"

namespace limb_ring::bench {

/// The cores that the processes of a case may use: the last one this process may use itself (the
/// first often serves the machine's interrupts); nothing where they are free.
std::optional<cpu_set_t> cores_for(Pinning pinning);

/// How many cores this process may use.
unsigned core_count();

/// Pins the calling process to these cores; nothing: leaves it free.
void stay_on(const std::optional<cpu_set_t>& cores);

}  // namespace limb_ring::bench
