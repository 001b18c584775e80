#include "io/memory_downstream.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include "io/unix_line_socket.h"

namespace limb_ring::link {

MemoryDownstream::MemoryDownstream(boost::asio::io_context& io, std::string path, const Identity& self,
                                   std::size_t candidate, std::size_t capacity, Owner& owner, OutputCounters& counters)
    : UnixDownstream(io, std::move(path), self, candidate, owner, counters), capacity_(capacity) {}

bool MemoryDownstream::greet(const LinkHeader& connect) {
  memory_ = QueueMemory::make(capacity_);
  // A limit on files (ulimit -f) stays as it is, so this is no attempt to be made again: it ends the daemon.
  if (!memory_ && errno == EFBIG)
    throw std::runtime_error(std::string("cannot make the queue of a line: ") + std::strerror(errno));
  wake_.reset(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (!memory_ || !wake_.valid()) {
    ++counters().queue_unavailable;
    return false;
  }
  queue_.emplace(*memory_);
  LinkHeader header = connect;
  header.type = LinkHeaderType::connect_memory;
  const auto bytes = encode_connect(header, agreement());
  const auto sent = send_now(socket(), {bytes.data(), bytes.size()}, {memory_->fd(), wake_.get()});
  return sent == static_cast<ssize_t>(bytes.size());
}

std::ptrdiff_t MemoryDownstream::put(wire::ByteView slices, std::string& reason) {
  const std::ptrdiff_t taken = queue_->put(slices);
  if (taken < 0) {
    ++counters().queue_invalid;
    reason = kInvalidQueue;
  } else if (queue_->must_wake()) {
    ::eventfd_write(wake_.get(), 1);
  }
  return taken;
}

// The reader sends a header when there is room.
std::uint32_t MemoryDownstream::wait_for_room() {
  if (!queue_->wait_for_room()) try_again();
  return EPOLLIN;
}

// Nothing to read here: headers come only with an end, or with room, and both wake this end.
void MemoryDownstream::tick() {
  if (queue_->heard_beat()) heard();
}

}  // namespace limb_ring::link
