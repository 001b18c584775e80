#pragma once

#include <chrono>

#include "limb_ring/captured_packet.h"
#include "wire/packet.h"

namespace limb_ring::capture {

/// A packet as it was seen on a line, before anybody has asked for a copy of it.
struct PacketView {
  std::chrono::nanoseconds at{0};  ///< of its last slice, by whatever clock the slices came with
  CaptureInfo info;
  wire::ByteView bytes;  ///< valid during the call that hands it over; at least a header

  bool whole() const { return !info.aborted && !info.truncated && bytes.size >= wire::kOverhead; }
  bool interrupt() const { return wire::PacketFields{bytes}.code().interrupt; }
  wire::NodeId source() const { return wire::PacketFields{bytes}.source(); }
};

}  // namespace limb_ring::capture
