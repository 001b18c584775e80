#pragma once

#include <array>
#include <functional>

#include "wire/data_packet.h"
#include "wire/packet_view.h"
#include "wire/slice.h"

namespace limb_ring::capture {

/// Puts the packets of one line together again from its slices: slices and time go in, packets come
/// out, each in the instant of its last slice. Knows no IO and no clock.
///
/// Slices of a packet whose beginning was not seen are passed over: looking may begin inside one.
class PacketAssembler {
 public:
  using Sink = std::function<void(const PacketView&)>;
  explicit PacketAssembler(Sink sink) : sink_(std::move(sink)) {}

  /// What comes from now on is on this line; see CaptureInfo.
  void set_line(bool input, wire::NodeId from, wire::NodeId to);
  void put(const wire::Slice& slice, std::chrono::nanoseconds at);
  /// Something is missing here, or the line has ended: what is open will never be whole.
  void gap(std::chrono::nanoseconds at);
  /// Forgets what is open: nobody looks any more.
  void reset() { open_ = false; }

 private:
  void begin(wire::ByteView bytes, std::chrono::nanoseconds at);
  void more(wire::ByteView bytes, std::chrono::nanoseconds at);
  void interrupt(wire::ByteView bytes, std::chrono::nanoseconds at);
  void close(std::chrono::nanoseconds at, bool CaptureInfo::*how);
  void give(CaptureInfo info, wire::ByteView bytes, std::chrono::nanoseconds at) const;

  Sink sink_;
  CaptureInfo line_;
  bool open_ = false;
  std::chrono::nanoseconds began_{0};
  std::size_t size_ = 0;
  std::array<std::uint8_t, wire::kMaxDataPacketSize> bytes_{};
};

}  // namespace limb_ring::capture
