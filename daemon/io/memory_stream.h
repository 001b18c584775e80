#pragma once

#include "io/memory_queue.h"
#include "io/unix_stream.h"

namespace limb_ring::link {

/// The end of a pipe that wakes us, opened anew: what we have been given the other node has too, and could make us wait
/// in it. @return invalid where it is no pipe
process::UniqueFd open_wake(const process::UniqueFd& given);

/// A stream whose slices come through shared memory. Its socket says who is there, and that it has ended.
class MemoryStream final : public UnixStream {
 public:
  /// @param wake open_wake()'s
  /// @throw std::system_error where one of them cannot be waited for
  MemoryStream(boost::asio::io_context& io, process::UniqueFd socket, QueueMemory memory, process::UniqueFd wake,
               const LinkHeader& alive, Owner& owner, InputHandler& handler, InputCounters& counters);

  /// Reads what has come meanwhile, and waits for more.
  void read() override;
  void tick() override;
  void close() override;

 private:
  void on_woken(std::uint32_t events);
  /// @return false: nothing is there, or this stream is over
  bool read_once();

  QueueMemory memory_;
  QueueReader queue_;
  process::UniqueFd wake_;
  event_loop::Watch woken_;
};

}  // namespace limb_ring::link
