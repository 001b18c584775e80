#pragma once

#include <optional>

#include "io/memory_queue.h"
#include "io/unix_downstream.h"

namespace limb_ring::link {

/// A candidate on this host reached through shared memory: the UNIX socket carries the handshake and the headers that
/// come back, and shows when the other end has gone; slices go into the queue.
class MemoryDownstream final : public UnixDownstream {
 public:
  /// @param capacity of the queue, bytes; as QueueMemory::make() takes it
  MemoryDownstream(boost::asio::io_context& io, std::string path, const Identity& self, std::size_t candidate,
                   std::size_t capacity, Owner& owner, OutputCounters& counters);
  void say_idle() override { queue_->beat(); }
  void tick() override;

 private:
  bool greet(const LinkHeader& connect) override;
  /// @return the other node's end of the pipe; invalid where the kernel gives none
  process::UniqueFd make_wake();
  std::ptrdiff_t put(wire::ByteView slices, std::string& reason) override;
  std::uint32_t wait_for_room() override;
  /// As much as a UNIX line's socket holds of small packets. The queue alone is too small: to stay in the cache it
  /// holds no more than one lap of a closed ring, but when a ring opens all nodes send at once what has waited. (ours)
  std::size_t may_wait() const override { return 256 * 1024; }

  std::size_t capacity_;
  std::optional<QueueMemory> memory_;
  std::optional<QueueWriter> queue_;
  process::UniqueFd wake_;  ///< our end of a pipe: whether it waits is ours alone, as it would not be of an eventfd
};

}  // namespace limb_ring::link
