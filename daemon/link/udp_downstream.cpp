#include "link/udp_downstream.h"

#include <boost/asio/post.hpp>
#include <cerrno>

#include "link/unix_socket.h"
#include "wire/slice.h"

namespace limb_ring::link {

UdpDownstream::UdpDownstream(boost::asio::io_context& io, UdpAddress address, const Identity& self,
                             std::size_t candidate, Owner& owner, OutputCounters& counters)
    : io_(io),
      address_(std::move(address)),
      self_(self),
      candidate_(candidate),
      owner_(&owner),
      counters_(counters),
      socket_(io),
      batch_(self, counters),
      session_(std::uint64_t{fresh_nonce()} << 32) {}

bool UdpDownstream::start() {
  socket_ = connect_udp(io_, address_);
  if (!socket_.is_open() || !tell(HeadType::connect)) return false;
  wait_for_heads();
  return true;
}

void UdpDownstream::wait_for_heads() {
  socket_.async_wait(UdpSocket::wait_read,
                     [self = shared_from_this()](const boost::system::error_code&) {
                       if (!self->open()) return;
                       self->read();
                       if (self->open() && !self->failed_) self->wait_for_heads();
                     });
}

void UdpDownstream::read() {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  std::array<std::uint8_t, kHeadSize> bytes;
  while (open() && !failed_) {
    const auto got = receive_now(socket_.native_handle(), bytes.data(), bytes.size());
    if (got < 0 && would_block(errno)) return;
    if (got < 0) {
      failed_ = true;
      return owner_->on_ended(candidate_, "nobody listens there");
    }
    const auto head = parse_head({bytes.data(), static_cast<std::size_t>(got)});
    if (head) take_head(*head);
  }
}

void UdpDownstream::take_head(const Head& head) {
  if (session_nonce(head.session) != session_nonce(session_)) return;
  if (head.type == HeadType::accept) return accept(head);
  if (accepted_ && head.session != session_) return;
  if (head.type == HeadType::refuse) return owner_->on_refused(candidate_, head);
  if (head.type == HeadType::alive) owner_->on_heard(candidate_);
}

void UdpDownstream::accept(const Head& head) {
  if (accepted_ || head.ring != self_.ring) return;
  accepted_ = true;
  session_ = head.session;
  batch_.start_session(session_);
  owner_->on_accepted(candidate_);
}

void UdpDownstream::write(wire::ByteView slices) {
  if (failed_ || !open()) {
    counters_.discarded += slices.size;
    return;
  }
  const std::size_t taken = backlog_.empty() ? send(slices) : 0;
  if (failed_ || taken == slices.size) return;
  if (backlog_.empty()) {
    ++counters_.blocked;
    wait_for_room();
  }
  if (!backlog_.add(slices.from(taken))) fail("too much waits for it");
}

bool UdpDownstream::hold_back(wire::ByteView slice) {
  return !failed_ && open() && backlog_.empty() && batch_.hold_back(slice);
}

std::size_t UdpDownstream::send(wire::ByteView slices) {
  const UdpBatch::Result result = batch_.send(socket_.native_handle(), slices);
  if (result.status == UdpBatch::Status::gone) fail("nobody listens there");
  return result.taken;
}

void UdpDownstream::wait_for_room() {
  socket_.async_wait(UdpSocket::wait_write,
                     [self = shared_from_this()](const boost::system::error_code&) {
                       if (self->open() && !self->failed_) self->send_backlog();
                     });
}

void UdpDownstream::send_backlog() {
  backlog_.remove(send(backlog_.view()));
  if (failed_) return;
  if (!backlog_.empty()) return wait_for_room();
  owner_->on_drained(candidate_);
}

void UdpDownstream::ask_again() {
  if (!accepted_ && !failed_ && !tell(HeadType::connect)) fail("nobody listens there");
}

bool UdpDownstream::tell(HeadType type) {
  Head head;
  head.type = type;
  head.ring = self_.ring;
  head.sender = self_.id;
  head.session = session_;
  const auto bytes = encode(head);
  const auto sent = send_now(socket_.native_handle(), {bytes.data(), bytes.size()});
  return sent >= 0 || would_block(errno);
}

void UdpDownstream::fail(std::string reason) {
  failed_ = true;
  boost::asio::post(io_, [self = shared_from_this(), reason = std::move(reason)] {
    if (self->open()) self->owner_->on_ended(self->candidate_, reason);
  });
}

void UdpDownstream::close() {
  if (open() && socket_.is_open() && accepted_) tell(HeadType::bye);
  sever();
}

void UdpDownstream::sever() {
  if (!open()) return;
  owner_ = nullptr;
  counters_.discarded += backlog_.size();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

}  // namespace limb_ring::link
