#include "link/unix_guest.h"

#include <sys/socket.h>

#include <cerrno>

namespace limb_ring::link {

void UnixGuest::wait() {
  socket_.async_wait(UnixSocket::wait_read,
                     [self = shared_from_this()](const boost::system::error_code&) {
                       if (self->host_ == nullptr) return;
                       self->read();
                       if (self->host_ != nullptr) self->wait();
                     });
}

void UnixGuest::read() {
  const auto self = shared_from_this();  // the host lets go of us in its call
  const auto got = receive_now(socket_.native_handle(), bytes_.data() + size_, kHeadSize - size_);
  if (got < 0 && would_block(errno)) return;
  if (got <= 0) return host_->on_stranger(self, "it left without a word");
  size_ += static_cast<std::size_t>(got);
  if (size_ == kHeadSize) greeted();
}

void UnixGuest::greeted() {
  const auto head = parse_head({bytes_.data(), size_});
  if (!head) return host_->on_stranger(shared_from_this(), kNoNode);
  if (head->type != HeadType::connect) {
    return host_->on_stranger(shared_from_this(), "it did not ask to connect");
  }
  host_->on_greeted(shared_from_this(), *head);
}

void UnixGuest::close() {
  host_ = nullptr;
  boost::system::error_code ignored;
  socket_.close(ignored);
}

bool UnixGuest::hung_up() {
  std::uint8_t byte;
  return ::recv(socket_.native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

void UnixGuest::answer(const Head& head) {
  const auto bytes = encode(head);
  send_now(socket_.native_handle(), {bytes.data(), bytes.size()});
}

UnixSocket UnixGuest::release() {
  host_ = nullptr;
  return std::move(socket_);
}

}  // namespace limb_ring::link
