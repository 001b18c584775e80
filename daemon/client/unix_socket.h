#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "client/stream_buffer.h"
#include "io/unique_fd.h"

namespace limb_ring::client {

/// A non-blocking UNIX stream socket, owned. Calls interrupted by a signal go on by themselves.
class UnixSocket {
 public:
  /// Nothing where it failed; `errno` says why.
  static std::optional<UnixSocket> connect(const std::string& path);

  explicit UnixSocket(process::UniqueFd fd) : fd_(std::move(fd)) {}

  int fd() const { return fd_.get(); }

  enum class Status { done, would_block, closed };
  /// Appends what has come, at most 64 kB, to `in`.
  Status read(StreamBuffer& in);
  /// Writes from the front of `out` on; `written` says how much went.
  Status write(wire::ByteView out, std::size_t& written);
  /// Waits for `events` (POLLIN, POLLOUT) until `deadline`.
  /// @return the events that came, an error or hang-up counting as all; 0 on time-out
  short wait(short events, std::chrono::steady_clock::time_point deadline) const;

 private:
  process::UniqueFd fd_;
};

}  // namespace limb_ring::client
