#pragma once

#include <optional>
#include <string>

#include "limb_ring/host_port.h"
#include "tools/firmware/node_cpu.h"

namespace limb_ring::firmware {

/// Of the ring.
Timestamps read_clocks(const HostPort& port);

/// What a user asks of it beside its work.
struct RunOptions {
  std::optional<nanoseconds> hang_after;       ///< from its start
  std::optional<nanoseconds> endless_loop_at;  ///< of the ring's virtual clock; not where that is over at its start
  std::string command_log;                     ///< path; empty: none
};

/// Runs the CPU on its host port until a stop signal, an order, or the end of the connection. The
/// daemon hears from it four times per `alive_period`, however idle it is.
/// @return exit code
/// @throw std::runtime_error where the log cannot be written, or there is no virtual clock to loop by
int run(HostPort& port, NodeCpu& cpu, nanoseconds alive_period, const RunOptions& options);

}  // namespace limb_ring::firmware
