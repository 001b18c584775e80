#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include "client/host_message.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::test {

/// A listening socket where a daemon's would be, for daemons that misbehave. It says nothing by
/// itself: put what it is to say with say() before or after a client connects.
class FakeDaemon {
 public:
  explicit FakeDaemon(const std::string& ring = "r", const std::string& node = "3")
      : path_(socket_path(make_ring_directory(ring), node, "host")) {
    listening_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path_.c_str(), path_.size() + 1);
    const bool ready =
        ::bind(listening_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 && ::listen(listening_, 8) == 0;
    if (!ready) throw std::runtime_error("cannot listen at " + path_);
  }
  ~FakeDaemon() {
    hang_up();
    ::close(listening_);
    ::unlink(path_.c_str());
  }
  FakeDaemon(const FakeDaemon&) = delete;
  FakeDaemon& operator=(const FakeDaemon&) = delete;

  void accept() { client_ = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC); }
  void say_bytes(const client::Bytes& bytes) {
    const ssize_t said = ::send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (said != static_cast<ssize_t>(bytes.size())) throw std::runtime_error("say: short write");
  }
  template <typename Kind>
  void say(const Kind& message) {
    client::Bytes bytes;
    client::append(bytes, message);
    say_bytes(bytes);
  }
  void welcome() {
    accept();
    say(client::Welcome{3, "left_knee", "r"});
  }
  /// Reads until at least `size` bytes are there.
  client::Bytes hear(std::size_t size) {
    client::Bytes heard;
    while (heard.size() < size) {
      std::uint8_t chunk[4096];
      const ssize_t got = ::recv(client_, chunk, sizeof chunk, 0);
      if (got <= 0) throw std::runtime_error("hear: the client is gone");
      heard.insert(heard.end(), chunk, chunk + got);
    }
    return heard;
  }
  /// Somebody waits to be accepted.
  bool is_tried() const {
    pollfd waiting{listening_, POLLIN, 0};
    return ::poll(&waiting, 1, 0) > 0;
  }
  /// The client that was accepted last is still there.
  bool has_client() const {
    char byte = 0;
    const ssize_t got = client_ < 0 ? 0 : ::recv(client_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return got > 0 || (got < 0 && errno == EAGAIN);
  }
  void hang_up() {
    if (client_ >= 0) ::close(client_);
    client_ = -1;
  }

 private:
  std::string path_;
  int listening_ = -1;
  int client_ = -1;
};

}  // namespace limb_ring::test
