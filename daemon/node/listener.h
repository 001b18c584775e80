#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <string>

#include "io/unix_listener.h"

namespace limb_ring::host {

/// The listening socket DIRECTORY/ID.host, with NAME.host linked to it; both are removed in the
/// end. What a dead daemon left there is replaced: the caller holds the node's lock.
class Listener {
 public:
  /// @throw std::runtime_error naming the path and what is wrong with it
  Listener(boost::asio::io_context& io, const std::string& directory, std::uint8_t id, const std::string& name);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  event_loop::UnixAcceptor& acceptor() { return socket_.acceptor(); }
  /// The socket is where it was made, and the name with it.
  bool is_in_place() const;
  /// Makes it again, in a folder that is there. @throw std::runtime_error
  void listen_again();
  void close();

 private:
  void link_name() const;

  event_loop::UnixListener socket_;
  std::string link_;  ///< empty: there is none
};

}  // namespace limb_ring::host
