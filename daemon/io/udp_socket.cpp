#include "io/udp_socket.h"

#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <netinet/udp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "io/unix_line.h"
#include "wire/slice.h"

#ifndef UDP_SEGMENT
#define UDP_SEGMENT 103
#endif
#ifndef UDP_GRO
#define UDP_GRO 104
#endif

namespace limb_ring::link {
namespace {

std::runtime_error failure(const Endpoint& endpoint, const std::string& what) {
  return std::runtime_error("cannot use udp " + to_string(endpoint) + ": " + what);
}

std::size_t segment_of(msghdr& message, std::size_t otherwise) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_UDP || c->cmsg_type != UDP_GRO) continue;
    int segment = 0;
    std::memcpy(&segment, CMSG_DATA(c), sizeof segment);
    if (segment > 0) return static_cast<std::size_t>(segment);
  }
  return otherwise;
}

void put_segment(msghdr& message, std::uint16_t segment) {
  cmsghdr* c = CMSG_FIRSTHDR(&message);
  c->cmsg_level = SOL_UDP;
  c->cmsg_type = UDP_SEGMENT;
  c->cmsg_len = CMSG_LEN(sizeof segment);
  std::memcpy(CMSG_DATA(c), &segment, sizeof segment);
}

}  // namespace

UdpAddress udp_address(const Endpoint& endpoint) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(endpoint.address, error);
  if (error) {
    throw failure(endpoint, "'" + endpoint.address + "' is not a numeric address such as 127.0.0.1");
  }
  return {address, endpoint.port};
}

UdpSocket listen_udp(boost::asio::io_context& io, const Endpoint& endpoint) {
  const UdpAddress address = udp_address(endpoint);
  UdpSocket socket(io);
  boost::system::error_code error;
  socket.open(address.protocol(), error);
  if (!error) socket.bind(address, error);
  if (error) throw failure(endpoint, error.message());
  enlarge_buffers(socket.native_handle());
  const int on = 1;  // an older kernel says no, and gives us one datagram per read
  ::setsockopt(socket.native_handle(), SOL_UDP, UDP_GRO, &on, sizeof on);
  return socket;
}

UdpSocket connect_udp(boost::asio::io_context& io, const UdpAddress& to) {
  UdpSocket socket(io);
  boost::system::error_code error;
  socket.open(to.protocol(), error);
  if (!error) socket.connect(to, error);
  if (error) {
    socket.close(error);
  } else {
    enlarge_buffers(socket.native_handle());
  }
  return socket;
}

UdpRead receive_run(int socket, std::uint8_t* space, std::size_t size, UdpAddress& from) {
  alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(sizeof(int))];
  iovec part{space, size};
  msghdr message{};
  message.msg_name = from.data();
  message.msg_namelen = static_cast<socklen_t>(from.capacity());
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  const ssize_t got = ::recvmsg(socket, &message, MSG_DONTWAIT);
  if (got < 0) return {got, 0};
  from.resize(message.msg_namelen);
  return {got, segment_of(message, static_cast<std::size_t>(got))};
}

std::uint32_t dropped_datagrams(int socket) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  ::getsockopt(socket, SOL_SOCKET, SO_MEMINFO, memory.data(), &size);
  return memory[SK_MEMINFO_DROPS];
}

ssize_t send_run(int socket, wire::ByteView bytes, std::size_t segment) {
  if (bytes.size <= segment) return send_now(socket, bytes);
  alignas(cmsghdr) std::uint8_t control[CMSG_SPACE(sizeof(std::uint16_t))] = {};
  iovec part{const_cast<std::uint8_t*>(bytes.data), bytes.size};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  put_segment(message, static_cast<std::uint16_t>(segment));
  return ::sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
}

namespace {

constexpr std::uint32_t kMaxRun = 64;  ///< the kernel's own limit (UDP_MAX_SEGMENTS)
constexpr std::size_t kMaxRunBytes = 60000;

std::size_t slice_size(wire::ByteView slices) {
  if (slices.size < wire::kSliceHeaderSize) return slices.size;
  return std::min(slices.size, wire::kSliceHeaderSize + wire::load_u16(slices.data + wire::kSliceSizeAt));
}

bool no_segments(int error) { return error == EIO || error == EINVAL || error == EOPNOTSUPP; }

}  // namespace

UdpBatch::UdpBatch(const Identity& self, OutputCounters& counters)
    : counters_(counters), buffer_(kMaxRunBytes + kLinkHeaderSize + wire::kMaxSliceSize + kSealSize) {
  header_.type = LinkHeaderType::slices;
  header_.ring = self.ring;
  header_.sender = self.id;
}

void UdpBatch::start_session(std::uint64_t session, Sealer* sealer) {
  sealer_ = sealer;
  header_.session = session;
  header_.sequence = 1;
  late_.clear();
}

bool UdpBatch::hold_back(wire::ByteView slice) {
  if (late_.size() == kMostLate) return false;
  size_ = 0;
  append(slice);
  late_.emplace_back(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
  return true;
}

// What the kernel does not take is lost, as on the wire.
void UdpBatch::send_late(int socket) {
  for (const auto& datagram : late_) {
    const bool sent = send_run(socket, {datagram.data(), datagram.size()}, datagram.size()) >= 0;
    ++counters_.writes;
    ++(sent ? counters_.datagrams : counters_.datagrams_unsent);
  }
  late_.clear();
}

UdpBatch::Result UdpBatch::send(int socket, wire::ByteView slices) {
  Result result{Status::sent, 0};
  while (result.taken < slices.size) {
    const Run run = fill(slices.from(result.taken));
    if (transmit(socket, run, result.status)) {
      result.taken += run.slices;
      if (!late_.empty()) send_late(socket);
    } else if (result.status != Status::sent) {
      break;
    }
  }
  return result;
}

UdpBatch::Run UdpBatch::fill(wire::ByteView slices) {
  Run run;
  size_ = 0;
  const std::uint32_t most = joined_ && late_.empty() ? kMaxRun : 1;
  while (run.slices < slices.size && run.count < most && size_ < kMaxRunBytes) {
    const wire::ByteView rest = slices.from(run.slices);
    const std::size_t size = slice_size(rest);
    if (run.count == 0) run.segment = overhead() + size;
    if (overhead() + size > run.segment) break;
    append(rest.first(size));
    ++run.count;
    run.slices += size;
    if (overhead() + size < run.segment) break;  // only the last one may be shorter
  }
  header_.sequence -= run.count;  // until they are sent
  return run;
}

void UdpBatch::append(wire::ByteView slice) {
  std::uint8_t* out = buffer_.data() + size_;
  store_header(out, header_);
  std::memcpy(out + kLinkHeaderSize, slice.data, slice.size);
  if (sealer_ != nullptr) sealer_->seal(out, kLinkHeaderSize + slice.size);
  size_ += overhead() + slice.size;
  ++header_.sequence;
}

bool UdpBatch::transmit(int socket, const Run& run, Status& status) {
  const ssize_t sent = send_run(socket, {buffer_.data(), size_}, run.segment);
  if (sent < 0 && would_block(errno)) {
    status = Status::blocked;
    return false;
  }
  if (sent < 0 && run.count > 1 && no_segments(errno)) {
    joined_ = false;
    return false;
  }
  if (sent < 0 && errno == ECONNREFUSED && sealer_ == nullptr) {
    status = Status::gone;
    return false;
  }
  ++counters_.writes;
  auto& counted = sent < 0 ? counters_.datagrams_unsent : counters_.datagrams;
  counted += run.count;
  header_.sequence += run.count;  // also if unsent: the other end then knows of the loss
  return true;
}

}  // namespace limb_ring::link
