#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "io/unique_fd.h"

namespace limb_ring::process {

/// Connects a UNIX stream socket that never waits. @return an invalid one if that failed; errno says why
inline UniqueFd connect_unix(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return {};
  }
  std::memcpy(address.sun_path, path.data(), path.size());
  UniqueFd made(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!made.valid()) return made;
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (::connect(made.get(), generic, sizeof address) == 0) return made;
  const int why = errno;
  made.reset();
  errno = why;
  return made;
}

/// Who is at the other end, as the kernel says (SO_PEERCRED); if it does not, no user.
inline ucred peer_of(int socket) {
  ucred peer{0, static_cast<uid_t>(-1), static_cast<gid_t>(-1)};
  socklen_t size = sizeof peer;
  ::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size);
  return peer;
}

/// The process there belongs to our user.
inline bool is_of_our_user(int socket) { return peer_of(socket).uid == ::geteuid(); }

/// An errno says only: not now.
inline bool would_block(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace limb_ring::process
