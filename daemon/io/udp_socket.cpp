#include "io/udp_socket.h"

#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <netinet/udp.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <cstring>
#include <stdexcept>

#include "io/unix_line_socket.h"

#ifndef UDP_SEGMENT
#define UDP_SEGMENT 103
#endif
#ifndef UDP_GRO
#define UDP_GRO 104
#endif

namespace limb_ring::link {
namespace {

std::runtime_error failure(const Endpoint& endpoint, const std::string& what) {
  return std::runtime_error("cannot use udp " + to_string(endpoint) + ": " + what);
}

std::size_t segment_of(msghdr& message, std::size_t otherwise) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_UDP || c->cmsg_type != UDP_GRO) continue;
    int segment = 0;
    std::memcpy(&segment, CMSG_DATA(c), sizeof segment);
    if (segment > 0) return static_cast<std::size_t>(segment);
  }
  return otherwise;
}

void put_segment(msghdr& message, std::uint16_t segment) {
  cmsghdr* c = CMSG_FIRSTHDR(&message);
  c->cmsg_level = SOL_UDP;
  c->cmsg_type = UDP_SEGMENT;
  c->cmsg_len = CMSG_LEN(sizeof segment);
  std::memcpy(CMSG_DATA(c), &segment, sizeof segment);
}

}  // namespace

UdpAddress udp_address(const Endpoint& endpoint) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(endpoint.address, error);
  if (error) {
    throw failure(endpoint, "'" + endpoint.address + "' is no numeric address, as 127.0.0.1 is");
  }
  return {address, endpoint.port};
}

UdpSocket listen_udp(boost::asio::io_context& io, const Endpoint& endpoint) {
  const UdpAddress address = udp_address(endpoint);
  UdpSocket socket(io);
  boost::system::error_code error;
  socket.open(address.protocol(), error);
  if (!error) socket.bind(address, error);
  if (error) throw failure(endpoint, error.message());
  enlarge_buffers(socket.native_handle());
  const int on = 1;  // an older kernel says no, and gives us one datagram per read
  ::setsockopt(socket.native_handle(), SOL_UDP, UDP_GRO, &on, sizeof on);
  return socket;
}

UdpSocket connect_udp(boost::asio::io_context& io, const UdpAddress& to) {
  UdpSocket socket(io);
  boost::system::error_code error;
  socket.open(to.protocol(), error);
  if (!error) socket.connect(to, error);
  if (error) {
    socket.close(error);
  } else {
    enlarge_buffers(socket.native_handle());
  }
  return socket;
}

UdpRead receive_run(int socket, std::uint8_t* space, std::size_t size, UdpAddress& from) {
  alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(sizeof(int))];
  iovec part{space, size};
  msghdr message{};
  message.msg_name = from.data();
  message.msg_namelen = static_cast<socklen_t>(from.capacity());
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  const ssize_t got = ::recvmsg(socket, &message, MSG_DONTWAIT);
  if (got < 0) return {got, 0};
  from.resize(message.msg_namelen);
  return {got, segment_of(message, static_cast<std::size_t>(got))};
}

std::uint32_t dropped_datagrams(int socket) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  ::getsockopt(socket, SOL_SOCKET, SO_MEMINFO, memory.data(), &size);
  return memory[SK_MEMINFO_DROPS];
}

ssize_t send_run(int socket, wire::ByteView bytes, std::size_t segment) {
  if (bytes.size <= segment) return send_now(socket, bytes);
  alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(sizeof(std::uint16_t))] = {};
  iovec part{const_cast<std::uint8_t*>(bytes.data), bytes.size};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  put_segment(message, static_cast<std::uint16_t>(segment));
  return ::sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace limb_ring::link
