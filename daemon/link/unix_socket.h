#pragma once

#include <sys/types.h>

#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/basic_stream_socket.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <string>
#include <vector>

#include "process/unique_fd.h"
#include "process/unix_socket.h"
#include "wire/bytes.h"

namespace limb_ring::link {

using process::would_block;

// With the event loop's own executor type: a type-erased executor costs time at every packet.
using LoopExecutor = boost::asio::io_context::executor_type;
using UnixSocket = boost::asio::basic_stream_socket<boost::asio::local::stream_protocol, LoopExecutor>;
using UnixAcceptor = boost::asio::basic_socket_acceptor<boost::asio::local::stream_protocol, LoopExecutor>;

/// What a line's socket holds at most, as far as the kernel lets us: more than a ring of 254
/// full packets.
constexpr int kSocketBuffer = 1 << 20;

/// Listens at `path`, readable by this user alone. A socket left over there is replaced: the
/// caller holds the node's lock, so its owner is dead.
/// @throw std::runtime_error naming the path, what is wrong and what would be right
UnixAcceptor listen_unix(boost::asio::io_context& io, const std::string& path);

/// Connects without waiting. @return an invalid one if nobody of our user listens, or the queue is full
process::UniqueFd connect_unix(const std::string& path);

void enlarge_buffers(int socket);
/// The other end is closed; what it sent before may still wait.
bool has_hung_up(int socket);

/// As send() and recv(), but they never wait and raise no signal. @return bytes, or -1 with errno
ssize_t send_now(int socket, wire::ByteView bytes);
ssize_t receive_now(int socket, std::uint8_t* space, std::size_t size);
/// The same with descriptors, at most kMostDescriptors: they come with the first of the bytes.
constexpr std::size_t kMostDescriptors = 2;
ssize_t send_now(int socket, wire::ByteView bytes, const std::vector<int>& descriptors);
/// @param descriptors those that came are added
ssize_t receive_now(int socket, std::uint8_t* space, std::size_t size, std::vector<process::UniqueFd>& descriptors);

}  // namespace limb_ring::link
