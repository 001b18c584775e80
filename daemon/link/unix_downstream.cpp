#include "link/unix_downstream.h"

#include <boost/asio/post.hpp>
#include <cerrno>
#include <system_error>

namespace limb_ring::link {

UnixDownstream::UnixDownstream(boost::asio::io_context& io, std::string path, const Identity& self,
                               std::size_t candidate, Owner& owner, OutputCounters& counters)
    : io_(io),
      path_(std::move(path)),
      self_(self),
      candidate_(candidate),
      owner_(&owner),
      counters_(counters),
      socket_(io) {}

bool UnixDownstream::start() {
  socket_ = connect_unix(io_, path_);
  if (!socket_.is_open()) return false;
  LinkHeader header;
  header.type = LinkHeaderType::connect;
  header.ring = self_.ring;
  header.sender = self_.id;
  header.session = std::uint64_t{fresh_nonce()} << 32;
  const auto bytes = encode(header);
  const auto sent = send_now(socket_.native_handle(), {bytes.data(), bytes.size()});
  if (sent != static_cast<ssize_t>(bytes.size())) return false;
  wait_for_headers();
  return true;
}

void UnixDownstream::wait_for_headers() {
  socket_.async_wait(UnixSocket::wait_read, [self = shared_from_this()](const boost::system::error_code&) {
    if (!self->open()) return;
    self->read();
    if (self->open() && !self->failed_) self->wait_for_headers();
  });
}

void UnixDownstream::read() {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  while (open() && !failed_) {
    const auto got =
        receive_now(socket_.native_handle(), header_.data() + header_size_, kLinkHeaderSize - header_size_);
    if (got < 0 && would_block(errno)) return;
    if (got <= 0) {
      failed_ = true;
      return owner_->on_ended(candidate_, "its end was closed");
    }
    header_size_ += static_cast<std::size_t>(got);
    if (header_size_ == kLinkHeaderSize) take_header();
  }
}

void UnixDownstream::take_header() {
  header_size_ = 0;
  const auto header = parse_header({header_.data(), header_.size()});
  if (header && header->type == LinkHeaderType::refuse) return owner_->on_refused(candidate_, *header);
  if (!header || header->ring != self_.ring) {
    failed_ = true;
    return owner_->on_no_node(candidate_);
  }
  if (header->type == LinkHeaderType::accept) return owner_->on_accepted(candidate_);
  owner_->on_heard(candidate_);
}

void UnixDownstream::write(wire::ByteView slices) {
  if (failed_ || !open()) {
    counters_.discarded += slices.size;
    return;
  }
  std::size_t taken = 0;
  if (backlog_.empty()) {
    ++counters_.writes;
    const auto sent = send_now(socket_.native_handle(), slices);
    if (sent < 0 && !would_block(errno)) return fail(std::generic_category().message(errno));
    taken = sent < 0 ? 0 : static_cast<std::size_t>(sent);
    if (taken == slices.size) return;
    ++counters_.blocked;
    wait_for_room();
  }
  if (!backlog_.add(slices.from(taken))) fail("it does not read, and too much waits for it");
}

void UnixDownstream::wait_for_room() {
  socket_.async_wait(UnixSocket::wait_write, [self = shared_from_this()](const boost::system::error_code&) {
    if (self->open() && !self->failed_) self->send_backlog();
  });
}

void UnixDownstream::send_backlog() {
  ++counters_.writes;
  const auto sent = send_now(socket_.native_handle(), backlog_.view());
  if (sent < 0 && !would_block(errno)) return fail(std::generic_category().message(errno));
  if (sent > 0) backlog_.remove(static_cast<std::size_t>(sent));
  if (!backlog_.empty()) return wait_for_room();
  owner_->on_drained(candidate_);
}

void UnixDownstream::fail(std::string reason) {
  failed_ = true;
  boost::asio::post(io_, [self = shared_from_this(), reason = std::move(reason)] {
    if (self->open()) self->owner_->on_ended(self->candidate_, reason);
  });
}

void UnixDownstream::close() {
  if (!open()) return;
  owner_ = nullptr;
  counters_.discarded += backlog_.size();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

}  // namespace limb_ring::link
