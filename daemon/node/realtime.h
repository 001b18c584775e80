#pragma once

#include <sched.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "config/ring_config.h"

namespace limb_ring::runtime {

/// The core of the node at `place` in a ring of `nodes`, out of those that are `allowed`: as many neighbours as
/// possible share one, so that few packets wake another core. @pre place < nodes, some are allowed
unsigned core_of(std::size_t place, std::size_t nodes, const std::vector<unsigned>& allowed);

/// Pins this process to cores, asks for SCHED_FIFO and locks its memory, as the configuration
/// says. If the rights are missing it says so once, with what would give them, and goes on.
/// @param place of this node in ring order
void apply_realtime(const config::RingConfig& ring, std::size_t place);

/// Pins this process, which holds a whole virtual ring, and the CPUs that it starts to the core it is on: they act one
/// after the other, and to wake another core costs more than what most of them do. `realtime.cores`, a list, is obeyed
/// instead.
void keep_on_one_core(const config::RingConfig& ring);

/// Starts the program of this process again in its place, with the same arguments, environment, pid and parent: for its
/// parent the process does not end. All descriptors but 0, 1 and 2 are closed.
/// If it cannot be executed (any more), the process ends, with a line in its log: whoever looks after it starts it.
/// @param cores that the new program may use; none: the same as this process
[[noreturn]] void re_exec(const std::optional<cpu_set_t>& cores);

/// "only 32 file descriptors may be open (ulimit -n), this node needs up to 88"; empty if that is enough. Beyond the
/// limit lines and clients are refused, for reasons that do not name it.
std::string too_few_descriptors(const config::RingConfig& ring);

/// Polls a condition from the event loop, for conditions whose change raises no event. `done` is called once: with
/// true when `condition` becomes true, with false after `patience`. If it is true already, from inside this call.
/// @param owner of what the two functions use: once it is gone, neither is called
void wait_until(boost::asio::io_context& io, const std::shared_ptr<void>& owner, std::function<bool()> condition,
                std::chrono::milliseconds patience, std::function<void(bool)> done);

}  // namespace limb_ring::runtime
