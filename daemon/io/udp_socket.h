#pragma once

#include <sys/types.h>

#include <boost/asio/basic_datagram_socket.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "io/endpoint.h"
#include "wire/bytes.h"

namespace limb_ring::link {

using UdpSocket = boost::asio::basic_datagram_socket<boost::asio::ip::udp, boost::asio::io_context::executor_type>;
using UdpAddress = boost::asio::ip::udp::endpoint;

/// @throw std::runtime_error where the address is not numeric, saying so
UdpAddress udp_address(const Endpoint& endpoint);

/// Bound to exactly this endpoint, taking runs of datagrams in one read where the kernel can.
/// @throw std::runtime_error naming the endpoint and the cause
UdpSocket listen_udp(boost::asio::io_context& io, const Endpoint& endpoint);

/// Connected, so that nobody else's datagrams reach it. @return a closed socket if that fails
UdpSocket connect_udp(boost::asio::io_context& io, const UdpAddress& to);

/// One read: a datagram, or a run of them that the kernel has joined (UDP_GRO). All have
/// `segment` bytes but the last, which may have fewer.
struct UdpRead {
  ssize_t size;  ///< -1: see errno
  std::size_t segment;
};
UdpRead receive_run(int socket, std::uint8_t* space, std::size_t size, UdpAddress& from);

/// How many datagrams the socket had no room for, since it was made; modulo 2^32.
std::uint32_t dropped_datagrams(int socket);

/// One write of a run of datagrams of `segment` bytes each (UDP_SEGMENT), the last one possibly
/// shorter; to the connected end. @return as send()
ssize_t send_run(int socket, wire::ByteView bytes, std::size_t segment);

}  // namespace limb_ring::link
