#pragma once

#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/unique_fd.h"
#include "wire/bytes.h"

namespace limb_ring::client {

using Bytes = std::vector<std::uint8_t>;

/// What travels on a host port (ours): frames on a UNIX stream socket.
///
///   | size 32, big-endian | type 8 | size - 1 bytes of body |
///
/// `size` counts type and body. Each direction has a greatest size; a larger one is malformed.
constexpr std::size_t kFrameHeaderSize = 5;
constexpr std::size_t kMaxSizeToDaemon = 64 * 1024;
constexpr std::size_t kMaxSizeToClient = 1024 * 1024;
/// Bytes of JSON in one message, with room for the fields before it.
constexpr std::size_t kMaxRequest = kMaxSizeToDaemon - 16;
constexpr std::size_t kMaxReply = kMaxSizeToClient - 16;

struct Frame {
  std::uint8_t type;
  wire::ByteView body;
};

/// Reads one frame from the front of `bytes`.
/// @return `frame`: `consumed` bytes were used, and `frame` points into `bytes`; `incomplete`:
///         more bytes are needed; `malformed`: no frame, and what follows cannot be trusted.
struct FrameParse {
  enum class Status { frame, incomplete, malformed } status;
  Frame frame;
  std::size_t consumed;
};
FrameParse parse_frame(wire::ByteView bytes, std::size_t max_size);

/// Appends one frame to `out`: fields in the order of the calls, the size filled in at the end.
class FrameWriter {
 public:
  FrameWriter(Bytes& out, std::uint8_t type);
  ~FrameWriter();
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  FrameWriter& u8(std::uint8_t value);
  FrameWriter& u16(std::uint16_t value);
  FrameWriter& u32(std::uint32_t value);
  FrameWriter& u64(std::uint64_t value);
  /// 16 bits of length, then the text; what is beyond 65535 bytes is cut off.
  FrameWriter& text(std::string_view value);
  /// Appends `bytes` without a length; the last field, as it takes all that is left of the frame.
  FrameWriter& rest(wire::ByteView bytes);
  FrameWriter& rest(std::string_view text);

 private:
  Bytes& out_;
  std::size_t start_;
};

/// Takes fields off a body, front to back. A body too short gives zeros and complete() false.
class FieldReader {
 public:
  explicit FieldReader(wire::ByteView body) : left_(body) {}

  std::uint8_t u8();
  std::uint16_t u16();
  std::uint32_t u32();
  std::uint64_t u64();
  std::string_view text();
  wire::ByteView rest();
  std::string_view rest_text();
  /// True if every field was there and nothing is left over.
  bool complete() const { return !short_ && left_.empty(); }

 private:
  wire::ByteView take(std::size_t size);

  wire::ByteView left_;
  bool short_ = false;
};

inline std::string_view as_text(wire::ByteView bytes) {
  return {reinterpret_cast<const char*>(bytes.data), bytes.size};
}

/// Bytes read from a stream and not yet used: a flat run, so that frames can be looked at in
/// place. Grows to the largest frame seen and stays so.
class StreamBuffer {
 public:
  wire::ByteView view() const { return {bytes_.data() + begin_, end_ - begin_}; }
  bool empty() const { return begin_ == end_; }

  /// Room for `size` bytes behind the last one; valid until the next call. See added().
  std::uint8_t* space(std::size_t size) {
    if (bytes_.size() - end_ < size) make_room(size);
    return bytes_.data() + end_;
  }
  void added(std::size_t size) { end_ += size; }
  /// @pre size <= view().size
  void used(std::size_t size) {
    begin_ += size;
    if (begin_ == end_) clear();
  }
  void clear() { begin_ = end_ = 0; }

 private:
  void make_room(std::size_t size) {
    if (begin_ > 0) std::memmove(bytes_.data(), bytes_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    if (bytes_.size() - end_ < size) bytes_.resize(end_ + size);
  }

  Bytes bytes_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

/// A non-blocking UNIX stream socket, owned. Calls interrupted by a signal go on by themselves.
class UnixSocket {
 public:
  /// Nothing if it failed; `errno` says why.
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
