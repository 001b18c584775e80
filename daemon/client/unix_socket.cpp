#include "client/unix_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace limb_ring::client {

namespace {

constexpr std::size_t kReadSize = 64 * 1024;
using Clock = std::chrono::steady_clock;

/// Up to `deadline`, a thousand seconds at most.
timespec left_until(Clock::time_point deadline) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::chrono::nanoseconds left = deadline - Clock::now();
  const std::int64_t ns = std::clamp<std::int64_t>(left.count(), 0, 1000 * kSecond);
  return {static_cast<time_t>(ns / kSecond), static_cast<long>(ns % kSecond)};
}

UnixSocket::Status status_of_errno() {
  const bool would_block = errno == EAGAIN || errno == EWOULDBLOCK;
  return would_block ? UnixSocket::Status::would_block : UnixSocket::Status::closed;
}

}  // namespace

std::optional<UnixSocket> UnixSocket::connect(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return std::nullopt;
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  UnixSocket made(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (made.fd_ < 0) return std::nullopt;
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (::connect(made.fd_, generic, sizeof address) == 0) return made;
  const int why = errno;
  made = UnixSocket(-1);
  errno = why;
  return std::nullopt;
}

UnixSocket& UnixSocket::operator=(UnixSocket&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

UnixSocket::~UnixSocket() {
  if (fd_ >= 0) ::close(fd_);
}

std::optional<unsigned> UnixSocket::peer_user() const {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (getsockopt(fd_, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  return peer.uid;
}

UnixSocket::Status UnixSocket::read(StreamBuffer& in) {
  std::uint8_t* space = in.space(kReadSize);
  ssize_t got = 0;
  do {
    got = ::recv(fd_, space, kReadSize, 0);
  } while (got < 0 && errno == EINTR);
  if (got < 0) return status_of_errno();
  in.added(static_cast<std::size_t>(got));
  return got > 0 ? Status::done : Status::closed;
}

UnixSocket::Status UnixSocket::write(wire::ByteView out, std::size_t& written) {
  ssize_t went = 0;
  do {
    went = ::send(fd_, out.data, out.size, MSG_NOSIGNAL);
  } while (went < 0 && errno == EINTR);
  written = static_cast<std::size_t>(std::max<ssize_t>(went, 0));
  return went >= 0 ? Status::done : status_of_errno();
}

short UnixSocket::wait(short events, Clock::time_point deadline) const {
  for (;;) {
    pollfd entry{fd_, events, 0};
    // Without a time-out the kernel sets no timer, which on a virtual machine costs more than all else.
    const timespec left = left_until(deadline);
    const int ready = ::ppoll(&entry, 1, deadline == Clock::time_point::max() ? nullptr : &left, nullptr);
    if (ready > 0) {
      const bool broken = (entry.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
      return broken ? events : static_cast<short>(entry.revents & events);
    }
    if (ready == 0 && Clock::now() >= deadline) return 0;
    if (ready < 0 && errno != EINTR) return events;
  }
}

}  // namespace limb_ring::client
