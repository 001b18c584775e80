#include "io/pending_connection.h"

#include <cerrno>

namespace limb_ring::link {

void PendingConnection::wait() {
  socket_.async_wait(event_loop::UnixSocket::wait_read, [self = shared_from_this()](const boost::system::error_code&) {
    if (self->owner_ == nullptr) return;
    self->read();
    if (self->owner_ != nullptr) self->wait();
  });
}

void PendingConnection::read() {
  const auto self = shared_from_this();  // the owner lets go of us in its call
  const auto got = receive_now(socket_.native_handle(), bytes_.data() + size_, wanted_ - size_, descriptors_);
  if (got < 0 && would_block(errno)) return;
  if (got <= 0) return owner_->on_unknown_peer(self, "it left without a word");
  // Each part of a header could bring some more.
  if (descriptors_.size() > kMostDescriptors) return owner_->on_unknown_peer(self, kNoNode);
  size_ += static_cast<std::size_t>(got);
  if (size_ < wanted_) return;
  if (wanted_ == kLinkHeaderSize && take_header()) return read();
  if (open() && wanted_ == kConnectSize)
    owner_->on_greeted(self, header_, load_agreement(bytes_.data() + kLinkHeaderSize));
}

bool PendingConnection::take_header() {
  const auto header = parse_header({bytes_.data(), size_});
  if (!header) {
    owner_->on_unknown_peer(shared_from_this(), kNoNode);
    return false;
  }
  if (header->type != LinkHeaderType::connect && header->type != LinkHeaderType::connect_memory) {
    owner_->on_unknown_peer(shared_from_this(), "it did not ask to connect");
    return false;
  }
  header_ = *header;
  if (header_.version != kLinkVersion) {  // what follows is known to that version alone
    owner_->on_greeted(shared_from_this(), header_, {});
    return false;
  }
  wanted_ = kConnectSize;
  return true;
}

void PendingConnection::close() {
  owner_ = nullptr;
  descriptors_.clear();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

bool PendingConnection::hung_up() { return has_hung_up(socket_.native_handle()); }

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
