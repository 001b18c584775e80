#pragma once

#include <sys/types.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/input.h"
#include "io/link_counters.h"
#include "io/link_header.h"
#include "io/output.h"
#include "io/packet_loop.h"
#include "io/unique_fd.h"
#include "io/unix_socket.h"
#include "wire/bytes.h"

namespace limb_ring::link {

using process::would_block;

/// What a line's socket holds at most, as far as the kernel lets us: more than a ring of 254
/// full packets.
constexpr int kSocketBuffer = 1 << 20;

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

/// The stream from our upstream neighbour: slices come in, headers go back.
class UnixStream : public std::enable_shared_from_this<UnixStream> {
 public:
  struct Owner {
    virtual void on_heard() = 0;
    /// Silence::stood_still(), now.
    virtual bool stood_still() const = 0;
    /// Suspension::noticed(), now.
    virtual bool was_suspended() = 0;
    virtual void on_ended(std::string_view reason) = 0;

   protected:
    ~Owner() = default;
  };

  /// @param alive what this end sends back while it lives
  /// @throw std::system_error if the socket cannot be waited for
  UnixStream(boost::asio::io_context& io, process::UniqueFd socket, const LinkHeader& alive, Owner& owner,
             InputHandler& handler, InputCounters& counters);
  virtual ~UnixStream() = default;

  /// Takes what has come. May call the handler and on_ended.
  virtual void read();
  /// Once per `idle`: says that this end lives.
  virtual void tick() { say_alive(); }
  /// Sends a header back; if the other end does not read, it is lost; headers are sent again.
  void tell(const LinkHeader& header);
  virtual void close();

 protected:
  bool open() const { return owner_ != nullptr; }
  /// This end stood still and the other one has given it up meanwhile, or other hosts may have given up both: ends the
  /// line with all that waits. @return false if that is not so
  bool ended_if_given_up();
  void say_alive() { tell(alive_); }
  SliceFeed& feed() { return feed_; }
  Owner& owner() { return *owner_; }
  InputCounters& counters() { return counters_; }
  /// So much was put into feed().space().
  void take(std::size_t size);
  /// What the socket said: the other end is gone.
  bool ending() const { return ending_; }

 private:
  process::UniqueFd socket_;
  LinkHeader alive_;
  Owner* owner_;
  InputHandler& handler_;
  InputCounters& counters_;
  SliceFeed feed_;
  bool ending_ = false;
  event_loop::Watch watch_;
};

/// A candidate reached over a UNIX-domain stream socket: a connect header and slices go out, headers
/// come back.
class UnixDownstream : public Downstream, public std::enable_shared_from_this<UnixDownstream> {
 public:
  UnixDownstream(boost::asio::io_context& io, std::string path, const Identity& self, std::size_t candidate,
                 Owner& owner, OutputCounters& counters);
  bool start() override;
  void write(wire::ByteView slices) override;
  bool drained() const override { return !failed_ && backlog_.size() <= may_wait(); }
  void tick() override { read(); }
  void ask_again() override {}
  void close() override;

 protected:
  /// Sends the first header. @return false if it cannot
  virtual bool greet(const LinkHeader& connect);
  /// Sends what there is room for. @return bytes sent; -1 and `reason` if the line has failed
  virtual std::ptrdiff_t put(wire::ByteView slices, std::string& reason);
  /// So many bytes may wait here before the line takes no more: none, since a socket holds enough.
  virtual std::size_t may_wait() const { return 0; }
  /// Called when something waits for room. @return the epoll events that tell of room
  virtual std::uint32_t wait_for_room();

  bool open() const { return owner_ != nullptr; }
  const Agreement& agreement() const { return self_.agreement; }
  int socket() const { return socket_.get(); }
  OutputCounters& counters() { return counters_; }
  /// What waits is sent soon.
  void try_again() { watch_.call_again(); }
  void heard() { owner_->on_heard(candidate_); }

 private:
  void read();
  void on_ready(std::uint32_t events);
  void take_header();
  void send_backlog();
  std::size_t send(wire::ByteView slices);
  void fail(std::string reason);

  boost::asio::io_context& io_;
  std::string path_;
  Identity self_;
  std::size_t candidate_;
  Owner* owner_;
  OutputCounters& counters_;
  process::UniqueFd socket_;
  std::array<std::uint8_t, kLinkHeaderSize> header_{};
  std::size_t header_size_ = 0;
  event_loop::Backlog backlog_{kMostWaiting};
  bool failed_ = false;
  event_loop::Watch watch_;
};

}  // namespace limb_ring::link
