#pragma once

#include <stdexcept>
#include <string>

#include "client/frame.h"
#include "client/host_message.h"
#include "limb_ring/ring_directory.h"

namespace limb_ring::test {

/// A client that says what it likes.
class RawClient {
 public:
  explicit RawClient(const std::string& ring, const std::string& node)
      : socket_(connect(socket_path(ring_directory(ring), node, "host"))) {}

  /// @return false if not all of it could be said
  bool say_bytes(wire::ByteView bytes) {
    std::size_t written = 0;
    socket_.write(bytes, written);
    return written == bytes.size;
  }
  bool say_bytes(const client::Bytes& bytes) { return say_bytes({bytes.data(), bytes.size()}); }
  template <typename Kind>
  bool say(const Kind& message) {
    client::Bytes bytes;
    client::append(bytes, message);
    return say_bytes(bytes);
  }
  /// True if the daemon has hung up; what it said before is kept for last_words().
  bool hung_up() {
    client::UnixSocket::Status status;
    do status = socket_.read(heard_);
    while (status == client::UnixSocket::Status::done);
    return status == client::UnixSocket::Status::closed;
  }
  /// The reason in the last message, which has to be Refused.
  std::string last_words() {
    std::string reason;
    for (;;) {
      const auto parse = client::parse_frame(heard_.view(), client::kMaxSizeToClient);
      if (parse.status != client::FrameParse::Status::frame) return reason;
      const auto message = client::decode_to_client(parse.frame);
      if (message && std::holds_alternative<client::Refused>(*message)) {
        reason = std::string(std::get<client::Refused>(*message).reason);
      }
      heard_.used(parse.consumed);
    }
  }

 private:
  static client::UnixSocket connect(const std::string& path) {
    auto socket = client::UnixSocket::connect(path);
    if (!socket) throw std::runtime_error("cannot connect to " + path);
    return std::move(*socket);
  }

  client::UnixSocket socket_;
  client::StreamBuffer heard_;
};

}  // namespace limb_ring::test
