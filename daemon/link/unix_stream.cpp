#include "link/unix_stream.h"

#include <cerrno>
#include <string>
#include <system_error>

namespace limb_ring::link {

void UnixStream::wait() {
  socket_.async_wait(UnixSocket::wait_read, [self = shared_from_this()](const boost::system::error_code&) {
    if (self->owner_ == nullptr) return;
    self->read();
    if (self->owner_ != nullptr) self->wait();
  });
}

void UnixStream::read() {
  const auto self = shared_from_this();  // the handler may close the input
  const auto got = receive_now(socket_.native_handle(), feed_.space(), feed_.space_size());
  if (got > 0) return take(static_cast<std::size_t>(got));
  if (got == 0 || (got < 0 && errno == ECONNRESET)) return owner_->on_ended("its end was closed");
  if (would_block(errno)) return;
  owner_->on_ended("reading failed: " + std::generic_category().message(errno));
}

void UnixStream::take(std::size_t size) {
  ++counters_.reads;
  counters_.bytes += size;
  owner_->on_heard();
  if (feed_.commit(size, handler_, counters_)) return;
  ++counters_.malformed;
  if (owner_ != nullptr) owner_->on_ended("what it sent is no slice");
}

void UnixStream::tell(const LinkHeader& header) {
  const auto bytes = encode(header);
  send_now(socket_.native_handle(), {bytes.data(), bytes.size()});
}

void UnixStream::close() {
  owner_ = nullptr;
  feed_.stop();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

}  // namespace limb_ring::link
