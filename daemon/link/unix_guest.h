#pragma once

#include <array>
#include <functional>
#include <memory>

#include "link/endpoint.h"
#include "link/head.h"
#include "link/unix_socket.h"

namespace limb_ring::link {

/// A pending connection: it has not yet said who it is. It has a buffer of one head and a deadline, and becomes the
/// input only when it is admitted.
class UnixGuest : public std::enable_shared_from_this<UnixGuest> {
 public:
  struct Host {
    virtual void on_greeted(const std::shared_ptr<UnixGuest>& guest, const Head& connect) = 0;
    virtual void on_stranger(const std::shared_ptr<UnixGuest>& guest, std::string_view why) = 0;

   protected:
    ~Host() = default;
  };

  UnixGuest(UnixSocket socket, Host& host, Time now)
      : socket_(std::move(socket)), host_(&host), since_(now) {}

  void start() { wait(); }
  void read();
  void close();
  bool open() const { return host_ != nullptr; }
  Time since() const { return since_; }
  /// True if the other end has closed meanwhile: a node that was frozen finds attempts that others gave up long ago.
  bool hung_up();
  void answer(const Head& head);
  /// Hands the socket over; the guest is closed then.
  UnixSocket release();

 private:
  void wait();
  void greeted();

  UnixSocket socket_;
  Host* host_;
  Time since_;
  std::array<std::uint8_t, kHeadSize> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace limb_ring::link
