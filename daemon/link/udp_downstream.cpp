#include "link/udp_downstream.h"

#include <sys/epoll.h>

#include <boost/asio/post.hpp>
#include <cerrno>

#include "link/unix_socket.h"

namespace limb_ring::link {
namespace {

/// Once a session is accepted, nothing that comes back is urgent: errors are always told.
constexpr std::uint32_t kForErrors = 0;

}  // namespace

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
  if (!socket_.is_open() || !tell(LinkHeaderType::connect)) return false;
  watch_ = event_loop::Watch(io_, socket_.native_handle(), EPOLLIN, [this](std::uint32_t events) { on_ready(events); });
  return true;
}

void UdpDownstream::on_ready(std::uint32_t events) {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  if ((events & ~static_cast<std::uint32_t>(EPOLLOUT)) != 0) read();
  if (open() && !failed_ && !backlog_.empty()) send_backlog();
}

void UdpDownstream::read() {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  std::array<std::uint8_t, kLinkHeaderSize> bytes;
  while (open() && !failed_) {
    const auto got = receive_now(socket_.native_handle(), bytes.data(), bytes.size());
    if (got < 0 && would_block(errno)) return;
    if (got < 0) {
      failed_ = true;
      return owner_->on_ended(candidate_, "nobody listens there");
    }
    const auto header = parse_header({bytes.data(), static_cast<std::size_t>(got)});
    if (header) take_header(*header);
  }
}

void UdpDownstream::take_header(const LinkHeader& header) {
  if (session_nonce(header.session) != session_nonce(session_)) return;
  if (header.type == LinkHeaderType::accept) return accept(header);
  if (accepted_ && header.session != session_) return;
  if (header.type == LinkHeaderType::refuse) return owner_->on_refused(candidate_, header);
  if (header.type == LinkHeaderType::alive) owner_->on_heard(candidate_);
}

void UdpDownstream::accept(const LinkHeader& header) {
  if (accepted_ || header.ring != self_.ring) return;
  accepted_ = true;
  session_ = header.session;
  batch_.start_session(session_);
  watch_.set_events(kForErrors);
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
    watch_.set_events(kForErrors | EPOLLOUT);
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

void UdpDownstream::send_backlog() {
  backlog_.remove(send(backlog_.view()));
  if (failed_ || !backlog_.empty()) return;
  watch_.set_events(kForErrors);
  owner_->on_drained(candidate_);
}

void UdpDownstream::ask_again() {
  if (!accepted_ && !failed_ && !tell(LinkHeaderType::connect)) fail("nobody listens there");
}

bool UdpDownstream::tell(LinkHeaderType type) {
  LinkHeader header;
  header.type = type;
  header.ring = self_.ring;
  header.sender = self_.id;
  header.session = session_;
  const auto bytes = encode_connect(header, self_.agreement);
  const std::size_t size = type == LinkHeaderType::connect ? bytes.size() : kLinkHeaderSize;
  const auto sent = send_now(socket_.native_handle(), {bytes.data(), size});
  return sent >= 0 || would_block(errno);
}

void UdpDownstream::fail(std::string reason) {
  failed_ = true;
  boost::asio::post(io_, [self = shared_from_this(), reason = std::move(reason)] {
    if (self->open()) self->owner_->on_ended(self->candidate_, reason);
  });
}

void UdpDownstream::close() {
  if (open() && socket_.is_open() && accepted_) tell(LinkHeaderType::bye);
  sever();
}

void UdpDownstream::sever() {
  if (!open()) return;
  owner_ = nullptr;
  counters_.discarded += backlog_.size();
  watch_.stop();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

}  // namespace limb_ring::link
