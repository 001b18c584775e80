#include "client/frame.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "io/unix_socket.h"

namespace limb_ring::client {
namespace {

constexpr std::size_t kSizeField = 4;
constexpr std::size_t kMaxText = 0xFFFF;

}  // namespace

FrameParse parse_frame(wire::ByteView bytes, std::size_t max_size) {
  if (bytes.size < kSizeField) return {FrameParse::Status::incomplete, {}, 0};
  const std::size_t size = wire::load_u32(bytes.data);
  if (size == 0 || size > max_size) return {FrameParse::Status::malformed, {}, 0};
  if (bytes.size - kSizeField < size) return {FrameParse::Status::incomplete, {}, 0};
  const Frame frame{bytes[kSizeField], bytes.first(kSizeField + size).from(kFrameHeaderSize)};
  return {FrameParse::Status::frame, frame, kSizeField + size};
}

FrameWriter::FrameWriter(Bytes& out, std::uint8_t type) : out_(out), start_(out.size()) {
  out_.resize(start_ + kSizeField);
  u8(type);
}

FrameWriter::~FrameWriter() {
  const std::size_t size = out_.size() - start_ - kSizeField;
  wire::store_u32(out_.data() + start_, static_cast<std::uint32_t>(size));
}

FrameWriter& FrameWriter::u8(std::uint8_t value) {
  out_.push_back(value);
  return *this;
}

FrameWriter& FrameWriter::u16(std::uint16_t value) {
  std::uint8_t bytes[2];
  wire::store_u16(bytes, value);
  return rest({bytes, sizeof bytes});
}

FrameWriter& FrameWriter::u32(std::uint32_t value) {
  std::uint8_t bytes[4];
  wire::store_u32(bytes, value);
  return rest({bytes, sizeof bytes});
}

FrameWriter& FrameWriter::u64(std::uint64_t value) {
  std::uint8_t bytes[8];
  wire::store_u64(bytes, value);
  return rest({bytes, sizeof bytes});
}

FrameWriter& FrameWriter::text(std::string_view value) {
  const std::string_view kept = value.substr(0, kMaxText);
  u16(static_cast<std::uint16_t>(kept.size()));
  return rest(kept);
}

FrameWriter& FrameWriter::rest(wire::ByteView bytes) {
  out_.insert(out_.end(), bytes.begin(), bytes.end());
  return *this;
}

FrameWriter& FrameWriter::rest(std::string_view text) {
  out_.insert(out_.end(), text.begin(), text.end());
  return *this;
}

wire::ByteView FieldReader::take(std::size_t size) {
  if (left_.size < size) {
    short_ = true;
    left_ = {};
    return {};
  }
  const wire::ByteView taken = left_.first(size);
  left_ = left_.from(size);
  return taken;
}

std::uint8_t FieldReader::u8() {
  const wire::ByteView bytes = take(1);
  return bytes.empty() ? std::uint8_t{0} : bytes[0];
}

std::uint16_t FieldReader::u16() {
  const wire::ByteView bytes = take(2);
  return bytes.empty() ? std::uint16_t{0} : wire::load_u16(bytes.data);
}

std::uint32_t FieldReader::u32() {
  const wire::ByteView bytes = take(4);
  return bytes.empty() ? 0 : wire::load_u32(bytes.data);
}

std::uint64_t FieldReader::u64() {
  const wire::ByteView bytes = take(8);
  return bytes.empty() ? 0 : wire::load_u64(bytes.data);
}

std::string_view FieldReader::text() { return as_text(take(u16())); }

wire::ByteView FieldReader::rest() { return take(left_.size); }

std::string_view FieldReader::rest_text() { return as_text(rest()); }

namespace {

constexpr std::size_t kReadSize = 64 * 1024;
using Clock = std::chrono::steady_clock;

/// Up to `deadline`, a thousand seconds at most.
timespec left_until(Clock::time_point deadline) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::chrono::nanoseconds left = deadline - Clock::now();
  const std::int64_t ns = std::clamp<std::int64_t>(left.count(), 0, 1000 * kSecond);
  return {static_cast<time_t>(ns / kSecond), static_cast<long>(ns % kSecond)};
}

UnixSocket::Status status_of_errno() {
  return process::would_block(errno) ? UnixSocket::Status::would_block : UnixSocket::Status::closed;
}

}  // namespace

std::optional<UnixSocket> UnixSocket::connect(const std::string& path) {
  process::UniqueFd made = process::connect_unix(path);
  if (!made.valid()) return std::nullopt;
  return UnixSocket(std::move(made));
}

UnixSocket::Status UnixSocket::read(StreamBuffer& in) {
  std::uint8_t* space = in.space(kReadSize);
  ssize_t got = 0;
  do {
    got = ::recv(fd_.get(), space, kReadSize, 0);
  } while (got < 0 && errno == EINTR);
  if (got < 0) return status_of_errno();
  in.added(static_cast<std::size_t>(got));
  return got > 0 ? Status::done : Status::closed;
}

UnixSocket::Status UnixSocket::write(wire::ByteView out, std::size_t& written) {
  ssize_t went = 0;
  do {
    went = ::send(fd_.get(), out.data, out.size, MSG_NOSIGNAL);
  } while (went < 0 && errno == EINTR);
  written = static_cast<std::size_t>(std::max<ssize_t>(went, 0));
  return went >= 0 ? Status::done : status_of_errno();
}

short UnixSocket::wait(short events, Clock::time_point deadline) const {
  for (;;) {
    pollfd entry{fd_.get(), events, 0};
    // Without a time-out the kernel sets no timer, which on a virtual machine costs more than all else.
    const timespec left = left_until(deadline);
    const int ready = ::ppoll(&entry, 1, deadline == Clock::time_point::max() ? nullptr : &left, nullptr);
    if (ready > 0) {
      const bool broken = (entry.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
      return broken ? events : static_cast<short>(entry.revents & events);
    }
    if (ready == 0 && Clock::now() >= deadline) return 0;
    if (ready < 0 && errno != EINTR) return events;
  }
}

}  // namespace limb_ring::client
