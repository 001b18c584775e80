#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "io/endpoint.h"
#include "io/link_header.h"
#include "io/unix_line_socket.h"
#include "io/unix_listener.h"

namespace limb_ring::link {

/// A pending connection: it has not yet said who it is. It has a buffer of one `connect` and a deadline, and becomes
/// the input only when it is admitted.
class PendingConnection : public std::enable_shared_from_this<PendingConnection> {
 public:
  struct Owner {
    virtual void on_greeted(const std::shared_ptr<PendingConnection>& connection, const LinkHeader& connect,
                            const Agreement& theirs) = 0;
    virtual void on_unknown_peer(const std::shared_ptr<PendingConnection>& connection, std::string_view why) = 0;

   protected:
    ~Owner() = default;
  };

  PendingConnection(event_loop::UnixSocket socket, Owner& owner, Time now)
      : socket_(std::move(socket)), owner_(&owner), since_(now) {}

  void start() { wait(); }
  void read();
  void close();
  bool open() const { return owner_ != nullptr; }
  Time since() const { return since_; }
  /// True if the other end has closed meanwhile: a node that was frozen finds attempts that others gave up long ago.
  bool hung_up();
  void answer(const LinkHeader& header);
  /// What came with its header: for a line through shared memory, the memory and the pipe.
  std::vector<process::UniqueFd>& descriptors() { return descriptors_; }
  /// Hands the socket over; the connection is closed then.
  process::UniqueFd release();

 private:
  void wait();
  /// A whole header is there. @return false: nothing more is wanted of this connection
  bool take_header();

  event_loop::UnixSocket socket_;
  Owner* owner_;
  Time since_;
  std::array<std::uint8_t, kConnectSize> bytes_{};
  std::size_t wanted_ = kLinkHeaderSize;
  std::size_t size_ = 0;
  LinkHeader header_;
  std::vector<process::UniqueFd> descriptors_;
};

}  // namespace limb_ring::link
