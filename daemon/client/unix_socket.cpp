#include "client/unix_socket.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "io/unix_socket.h"

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
  return process::would_block(errno) ? UnixSocket::Status::would_block : UnixSocket::Status::closed;
}

}  // namespace

std::optional<UnixSocket> UnixSocket::connect(const std::string& path) {
  process::UniqueFd made = process::connect_unix(path);
  if (!made.valid()) return std::nullopt;
  return UnixSocket(std::move(made));
}

UnixSocket::Status UnixSocket::read(StreamBuffer& in) {
  std::uint8_t* space = in.space(kReadSize);
  ssize_t got = 0;
  do {
    got = ::recv(fd_.get(), space, kReadSize, 0);
  } while (got < 0 && errno == EINTR);
  if (got < 0) return status_of_errno();
  in.added(static_cast<std::size_t>(got));
  return got > 0 ? Status::done : Status::closed;
}

UnixSocket::Status UnixSocket::write(wire::ByteView out, std::size_t& written) {
  ssize_t went = 0;
  do {
    went = ::send(fd_.get(), out.data, out.size, MSG_NOSIGNAL);
  } while (went < 0 && errno == EINTR);
  written = static_cast<std::size_t>(std::max<ssize_t>(went, 0));
  return went >= 0 ? Status::done : status_of_errno();
}

short UnixSocket::wait(short events, Clock::time_point deadline) const {
  for (;;) {
    pollfd entry{fd_.get(), events, 0};
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
