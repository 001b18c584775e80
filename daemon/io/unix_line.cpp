#include "io/unix_line.h"

#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include <boost/asio/post.hpp>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace limb_ring::link {

process::UniqueFd connect_unix(const std::string& path) {
  process::UniqueFd line = process::connect_unix(path);
  if (!line.valid() || !process::is_of_our_user(line.get())) return {};
  enlarge_buffers(line.get());
  return line;
}

void enlarge_buffers(int socket) {
  // The kernel cuts it down to its limit; what we get then is enough on every stock system.
  ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kSocketBuffer, sizeof kSocketBuffer);
  ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &kSocketBuffer, sizeof kSocketBuffer);
}

bool has_hung_up(int socket) {
  pollfd asked{socket, POLLRDHUP, 0};
  return ::poll(&asked, 1, 0) == 1;
}

ssize_t send_now(int socket, wire::ByteView bytes) {
  return ::send(socket, bytes.data, bytes.size, MSG_DONTWAIT | MSG_NOSIGNAL);
}

ssize_t receive_now(int socket, std::uint8_t* space, std::size_t size) {
  return ::recv(socket, space, size, MSG_DONTWAIT);
}

ssize_t send_now(int socket, wire::ByteView bytes, const std::vector<int>& descriptors) {
  alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(kMostDescriptors * sizeof(int))] = {};
  const std::size_t size = descriptors.size() * sizeof(int);
  iovec part{const_cast<std::uint8_t*>(bytes.data), bytes.size};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = CMSG_SPACE(size);
  cmsghdr* header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(size);
  std::memcpy(CMSG_DATA(header), descriptors.data(), size);
  return ::sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
}

ssize_t receive_now(int socket, std::uint8_t* space, std::size_t size, std::vector<process::UniqueFd>& descriptors) {
  alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(kMostDescriptors * sizeof(int))];
  iovec part{space, size};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  const ssize_t got = ::recvmsg(socket, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  if (got < 0) return got;
  for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr; header = CMSG_NXTHDR(&message, header)) {
    if (header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_RIGHTS) continue;
    for (std::size_t at = 0; at + sizeof(int) <= header->cmsg_len - CMSG_LEN(0); at += sizeof(int)) {
      int descriptor;
      std::memcpy(&descriptor, CMSG_DATA(header) + at, sizeof descriptor);
      descriptors.emplace_back(descriptor);
    }
  }
  return got;
}

UnixStream::UnixStream(boost::asio::io_context& io, process::UniqueFd socket, const LinkHeader& alive, Owner& owner,
                       InputHandler& handler, InputCounters& counters)
    : socket_(std::move(socket)),
      alive_(alive),
      owner_(&owner),
      handler_(handler),
      counters_(counters),
      watch_(io, socket_.get(), EPOLLIN | EPOLLRDHUP, [this](std::uint32_t events) {
        if ((events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) != 0) ending_ = true;
        read();
      }) {}

// epoll tells of the end only once, but what came before it may take more than one read.
void UnixStream::read() {
  const auto self = shared_from_this();  // the handler may close the input
  if (ended_if_given_up()) return;
  const std::size_t space = feed_.space_size();
  const auto got = receive_now(socket_.get(), feed_.space(), space);
  if (got > 0) {
    watch_.found_packets();
    take(static_cast<std::size_t>(got));
    if (open() && (ending_ || static_cast<std::size_t>(got) == space)) watch_.call_again();
    return;
  }
  if (got == 0 || (got < 0 && errno == ECONNRESET)) return owner_->on_ended("its end was closed");
  if (would_block(errno)) return;
  owner_->on_ended("reading failed: " + std::generic_category().message(errno));
}

// What waits is old then: packets have taken the way past this node since, and their copies would come behind them.
bool UnixStream::ended_if_given_up() {
  const bool given_up = owner_->was_suspended() || (owner_->stood_still() && has_hung_up(socket_.get()));
  if (!given_up) return false;
  ++counters_.given_up;
  owner_->on_ended(kGivenUp);
  return true;
}

void UnixStream::take(std::size_t size) {
  ++counters_.reads;
  counters_.bytes += size;
  owner_->on_heard();
  if (feed_.commit(size, handler_, counters_)) return;
  ++counters_.malformed;
  if (owner_ != nullptr) owner_->on_ended("what it sent is not a slice");
}

void UnixStream::tell(const LinkHeader& header) {
  const auto bytes = encode(header);
  send_now(socket_.get(), {bytes.data(), bytes.size()});
}

void UnixStream::close() {
  owner_ = nullptr;
  feed_.stop();
  watch_.stop();
  socket_.reset();
}

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
