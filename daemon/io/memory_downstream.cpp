#include "io/memory_downstream.h"

#include <fcntl.h>
#include <sys/epoll.h>
#include <unistd.h>

#include <array>
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
  const process::UniqueFd others_end = make_wake();
  if (!memory_ || !others_end.valid()) {
    ++counters().queue_unavailable;
    return false;
  }
  queue_.emplace(*memory_);
  LinkHeader header = connect;
  header.type = LinkHeaderType::connect_memory;
  const auto bytes = encode_connect(header, agreement());
  const auto sent = send_now(socket(), {bytes.data(), bytes.size()}, {memory_->fd(), others_end.get()});
  return sent == static_cast<ssize_t>(bytes.size());
}

process::UniqueFd MemoryDownstream::make_wake() {
  std::array<int, 2> ends{-1, -1};
  if (::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC) != 0) return {};
  wake_.reset(ends[1]);
  return process::UniqueFd(ends[0]);
}

std::ptrdiff_t MemoryDownstream::put(wire::ByteView slices, std::string& reason) {
  const std::ptrdiff_t taken = queue_->put(slices);
  if (taken < 0) {
    ++counters().queue_invalid;
    reason = kInvalidQueue;
  } else if (queue_->must_wake()) {
    (void)!::write(wake_.get(), "", 1);  // full, or without a reader: then there is nobody to wake
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
