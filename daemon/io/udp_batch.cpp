#include "io/udp_batch.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "io/udp_socket.h"
#include "io/unix_line_socket.h"
#include "wire/slice.h"

namespace limb_ring::link {
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
  header_.sequence += run.count;  // also where unsent: the other end then knows of the loss
  return true;
}

}  // namespace limb_ring::link
