#include "io/unix_downstream.h"

#include <sys/epoll.h>

#include <boost/asio/post.hpp>
#include <cerrno>
#include <system_error>

#include "io/unix_line_socket.h"

namespace limb_ring::link {
namespace {

/// Events until the other end has accepted. Afterwards nothing that comes back is urgent but its end.
constexpr std::uint32_t kForAnswer = EPOLLIN | EPOLLRDHUP;
constexpr std::uint32_t kForEnd = EPOLLRDHUP;

}  // namespace

UnixDownstream::UnixDownstream(boost::asio::io_context& io, std::string path, const Identity& self,
                               std::size_t candidate, Owner& owner, OutputCounters& counters)
    : io_(io), path_(std::move(path)), self_(self), candidate_(candidate), owner_(&owner), counters_(counters) {}

bool UnixDownstream::start() {
  socket_ = connect_unix(path_);
  if (!socket_.valid()) return false;
  LinkHeader header;
  header.type = LinkHeaderType::connect;
  header.ring = self_.ring;
  header.sender = self_.id;
  header.session = std::uint64_t{fresh_nonce()} << 32;
  if (!greet(header)) return false;
  watch_ = event_loop::Watch(io_, socket_.get(), kForAnswer, [this](std::uint32_t events) { on_ready(events); });
  return true;
}

bool UnixDownstream::greet(const LinkHeader& connect) {
  const auto bytes = encode_connect(connect, self_.agreement);
  return send_now(socket_.get(), {bytes.data(), bytes.size()}) == static_cast<ssize_t>(bytes.size());
}

void UnixDownstream::on_ready(std::uint32_t events) {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  if (events != EPOLLOUT) read();
  if (open() && !failed_ && !backlog_.empty()) send_backlog();
}

void UnixDownstream::read() {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  for (int reads = 0; open() && !failed_; ++reads) {
    if (reads == kMostHeaders) return watch_.call_again();
    const auto got = receive_now(socket_.get(), header_.data() + header_size_, kLinkHeaderSize - header_size_);
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
  if (header->type != LinkHeaderType::accept) return owner_->on_heard(candidate_);
  watch_.set_events(kForEnd);
  owner_->on_accepted(candidate_);
}

void UnixDownstream::write(wire::ByteView slices) {
  if (failed_ || !open()) {
    counters_.discarded += slices.size;
    return;
  }
  const bool waited = !backlog_.empty();
  const std::size_t taken = waited ? 0 : send(slices);
  if (failed_ || taken == slices.size) return;
  if (!backlog_.add(slices.from(taken))) return fail("it does not read, and too much waits for it");
  if (waited) return;
  ++counters_.blocked;
  watch_.set_events(kForEnd | wait_for_room());
}

std::size_t UnixDownstream::send(wire::ByteView slices) {
  ++counters_.writes;
  std::string reason;
  const std::ptrdiff_t sent = put(slices, reason);
  if (sent < 0) fail(std::move(reason));
  return sent < 0 ? 0 : static_cast<std::size_t>(sent);
}

std::ptrdiff_t UnixDownstream::put(wire::ByteView slices, std::string& reason) {
  const auto sent = send_now(socket_.get(), slices);
  if (sent >= 0) return sent;
  if (would_block(errno)) return 0;
  reason = std::generic_category().message(errno);
  return -1;
}

std::uint32_t UnixDownstream::wait_for_room() { return EPOLLOUT; }

void UnixDownstream::send_backlog() {
  backlog_.remove(send(backlog_.view()));
  if (failed_) return;
  if (!backlog_.empty()) return watch_.set_events(kForEnd | wait_for_room());
  watch_.set_events(kForEnd);
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
  watch_.stop();
  socket_.reset();
}

}  // namespace limb_ring::link
