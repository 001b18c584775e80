#pragma once

#include <sys/types.h>

#include <boost/asio/local/stream_protocol.hpp>
#include <string>

#include "wire/bytes.h"

namespace limb_ring::link {

using UnixSocket = boost::asio::local::stream_protocol::socket;
using UnixAcceptor = boost::asio::local::stream_protocol::acceptor;

/// What a line's socket holds at most, as far as the kernel lets us: more than a ring of 254
/// full packets.
constexpr int kSocketBuffer = 1 << 20;

/// Listens at `path`, readable by this user alone. A socket left over there is replaced: the
/// caller holds the node's lock, so its owner is dead.
/// @throw std::runtime_error naming the path, what is wrong and what would be right
UnixAcceptor listen_unix(boost::asio::io_context& io, const std::string& path);

/// Connects without waiting. @return a closed socket where nobody listens or the queue is full.
UnixSocket connect_unix(boost::asio::io_context& io, const std::string& path);

/// True where the process at the other end belongs to our user.
bool same_user(int socket);

void enlarge_buffers(int socket);

/// send() and recv() that never wait and raise no signal; as those, -1 with errno.
ssize_t send_now(int socket, wire::ByteView bytes);
ssize_t receive_now(int socket, std::uint8_t* space, std::size_t size);
/// True where an errno says only: not now.
bool would_block(int error);

}  // namespace limb_ring::link
