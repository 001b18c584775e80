#pragma once

#include <memory>
#include <string_view>

#include "link/link_header.h"
#include "link/slice_feed.h"
#include "link/unix_socket.h"

namespace limb_ring::link {

/// The stream from our upstream neighbour: slices come in, headers go back.
class UnixStream : public std::enable_shared_from_this<UnixStream> {
 public:
  struct Owner {
    virtual void on_heard() = 0;
    virtual void on_ended(std::string_view reason) = 0;

   protected:
    ~Owner() = default;
  };

  UnixStream(UnixSocket socket, Owner& owner, InputHandler& handler, InputCounters& counters)
      : socket_(std::move(socket)), owner_(&owner), handler_(handler), counters_(counters) {}

  void start() { wait(); }
  /// Takes what has come, once. May call the handler and on_ended.
  void read();
  /// Sends a header back; if the other end does not read, it is lost; headers are sent again.
  void tell(const LinkHeader& header);
  void close();

 private:
  void wait();
  void take(std::size_t size);

  UnixSocket socket_;
  Owner* owner_;
  InputHandler& handler_;
  InputCounters& counters_;
  SliceFeed feed_;
};

}  // namespace limb_ring::link
