#include "wire/packet_assembler.h"

#include <cstring>

namespace limb_ring::capture {

using std::chrono::nanoseconds;
using wire::ByteView;
using wire::SliceKind;

void PacketAssembler::set_line(bool input, wire::NodeId from, wire::NodeId to) {
  line_.input = input;
  line_.from = from;
  line_.to = to;
}

void PacketAssembler::put(const wire::Slice& slice, nanoseconds at) {
  switch (slice.kind) {
    case SliceKind::whole:
      gap(at);
      return give(line_, slice.bytes, at);
    case SliceKind::start:
      gap(at);
      return begin(slice.bytes, at);
    case SliceKind::more:
      return more(slice.bytes, at);
    case SliceKind::end:
      more(slice.bytes, at);
      return close(at, nullptr);
    case SliceKind::interrupt:
      return interrupt(slice.bytes, at);
    case SliceKind::abort:
      return close(at, &CaptureInfo::aborted);
    case SliceKind::idle:
    case SliceKind::fold:
      return;
  }
}

void PacketAssembler::gap(nanoseconds at) { close(at, &CaptureInfo::truncated); }

void PacketAssembler::begin(ByteView bytes, nanoseconds at) {
  open_ = true;
  began_ = at;
  size_ = 0;
  more(bytes, at);
}

void PacketAssembler::more(ByteView bytes, nanoseconds at) {
  if (!open_) return;
  if (size_ + bytes.size > bytes_.size()) return gap(at);
  std::memcpy(bytes_.data() + size_, bytes.data, bytes.size);
  size_ += bytes.size;
}

void PacketAssembler::interrupt(ByteView bytes, nanoseconds at) {
  CaptureInfo info = line_;
  if (open_) {
    info.embedded = true;
    info.carrier_source = bytes_[wire::field::kSource];
    info.carrier_code = bytes_[wire::field::kCode];
    info.carrier_offset = static_cast<std::uint16_t>(size_);
  }
  give(info, bytes, at);
}

void PacketAssembler::close(nanoseconds at, bool CaptureInfo::*how) {
  if (!open_) return;
  open_ = false;
  CaptureInfo info = line_;
  info.span = at - began_;
  if (how != nullptr) info.*how = true;
  give(info, {bytes_.data(), size_}, at);
}

void PacketAssembler::give(CaptureInfo info, ByteView bytes, nanoseconds at) const {
  const wire::PacketFields packet{bytes};
  info.retry = packet.code().attempt != 0;
  info.own = packet.source() == (info.input ? info.to : info.from);
  const bool complete = !info.aborted && !info.truncated;
  info.crc_bad = complete && !packet.crc_good();
  sink_({at, info, bytes});
}

}  // namespace limb_ring::capture
