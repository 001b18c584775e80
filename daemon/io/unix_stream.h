#pragma once

#include <memory>
#include <string_view>

#include "io/link_header.h"
#include "io/slice_feed.h"
#include "io/unique_fd.h"
#include "io/watch.h"

namespace limb_ring::link {

/// The stream from our upstream neighbour: slices come in, headers go back.
class UnixStream : public std::enable_shared_from_this<UnixStream> {
 public:
  struct Owner {
    virtual void on_heard() = 0;
    /// Silence::stood_still(), now.
    virtual bool stood_still() const = 0;
    virtual void on_ended(std::string_view reason) = 0;

   protected:
    ~Owner() = default;
  };

  /// @param alive what this end sends back while it lives
  /// @throw std::system_error where the socket cannot be waited for
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
  /// This end stood still and the other one has given it up meanwhile: ends the line with all that waits. @return false
  /// where that is not so
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

}  // namespace limb_ring::link
