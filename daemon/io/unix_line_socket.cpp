#include "io/unix_line_socket.h"

#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

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

}  // namespace limb_ring::link
