#pragma once

#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/basic_stream_socket.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <string>

namespace limb_ring::event_loop {

// With the event loop's own executor type: a type-erased executor costs time at every packet.
using LoopExecutor = boost::asio::io_context::executor_type;
using UnixSocket = boost::asio::basic_stream_socket<boost::asio::local::stream_protocol, LoopExecutor>;
using UnixAcceptor = boost::asio::basic_socket_acceptor<boost::asio::local::stream_protocol, LoopExecutor>;

/// A UNIX stream socket that listens at a path, for this user alone. The path is removed in the end.
class UnixListener {
 public:
  /// A socket left over there is replaced: the caller holds the node's lock, so its owner is dead.
  /// @throw std::runtime_error naming the path, what is wrong and what would be right
  UnixListener(boost::asio::io_context& io, std::string path);
  ~UnixListener();
  UnixListener(const UnixListener&) = delete;
  UnixListener& operator=(const UnixListener&) = delete;

  UnixAcceptor& acceptor() { return acceptor_; }
  const std::string& path() const { return path_; }
  /// The socket is where it was made, as far as can be seen.
  bool is_in_place() const;
  /// Makes it again, in a folder that is there. The accept under way ends with the old one. @throw as the constructor
  void listen_again();
  void close();

 private:
  boost::asio::io_context& io_;
  std::string path_;
  UnixAcceptor acceptor_;
};

/// Removes a socket, or a link to one, that a dead daemon has left there, and nothing else.
/// @throw std::runtime_error naming the path, what is wrong and what would be right
void remove_leftover(const std::string& path);

}  // namespace limb_ring::event_loop
