#pragma once

#include "config/ring_config.h"

namespace limb_ring::runtime {

/// Pins this process to cores, asks for SCHED_FIFO and locks its memory, as the configuration
/// says. Where the rights are missing it says so once, with what would give them, and goes on.
void apply_realtime(const config::Realtime& realtime);

}  // namespace limb_ring::runtime
