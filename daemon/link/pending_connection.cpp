#include "link/pending_connection.h"

#include <sys/socket.h>

#include <cerrno>

namespace limb_ring::link {

void PendingConnection::wait() {
  socket_.async_wait(UnixSocket::wait_read, [self = shared_from_this()](const boost::system::error_code&) {
    if (self->owner_ == nullptr) return;
    self->read();
    if (self->owner_ != nullptr) self->wait();
  });
}

void PendingConnection::read() {
  const auto self = shared_from_this();  // the owner lets go of us in its call
  const auto got = receive_now(socket_.native_handle(), bytes_.data() + size_, kLinkHeaderSize - size_, descriptors_);
  if (got < 0 && would_block(errno)) return;
  if (got <= 0) return owner_->on_unknown_peer(self, "it left without a word");
  size_ += static_cast<std::size_t>(got);
  if (size_ == kLinkHeaderSize) greeted();
}

void PendingConnection::greeted() {
  const auto header = parse_header({bytes_.data(), size_});
  if (!header) return owner_->on_unknown_peer(shared_from_this(), kNoNode);
  if (descriptors_.size() > kMostDescriptors) return owner_->on_unknown_peer(shared_from_this(), kNoNode);
  if (header->type != LinkHeaderType::connect && header->type != LinkHeaderType::connect_memory) {
    return owner_->on_unknown_peer(shared_from_this(), "it did not ask to connect");
  }
  owner_->on_greeted(shared_from_this(), *header);
}

void PendingConnection::close() {
  owner_ = nullptr;
  boost::system::error_code ignored;
  socket_.close(ignored);
}

bool PendingConnection::hung_up() {
  std::uint8_t byte;
  return ::recv(socket_.native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

void PendingConnection::answer(const LinkHeader& header) {
  const auto bytes = encode(header);
  send_now(socket_.native_handle(), {bytes.data(), bytes.size()});
}

process::UniqueFd PendingConnection::release() {
  owner_ = nullptr;
  boost::system::error_code error;
  return process::UniqueFd(socket_.release(error));
}

}  // namespace limb_ring::link
