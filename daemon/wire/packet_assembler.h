#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "limb_ring/captured_packet.h"
#include "wire/packet.h"
#include "wire/slice.h"

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

/// Puts the packets of one line together again from its slices: slices and time go in, packets come
/// out, each in the instant of its last slice. Knows no IO and no clock.
///
/// Slices of a packet whose beginning was not seen are ignored: observing may begin inside a packet.
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

/// What a capture says of a packet on one line, without its data: all that is needed to follow it. (ours)
struct SeenPacket {
  std::chrono::nanoseconds began{0};  ///< its first slice, by the capture's clock
  std::chrono::nanoseconds last{0};   ///< its last slice; on a paced line its last odd bytes, trailer and CRC follow
  CaptureInfo info;
  std::uint8_t code = 0;  ///< incarnation, kind, try and sequence
  std::uint8_t hop = 0;
  wire::NodeId source{0};
  std::uint16_t size = 0;  ///< bytes, header to CRC
  /// The trailer's; nothing if the packet broke off before it.
  struct Trailer {
    std::uint8_t fbc = 0;
    wire::NodeId destination{0};
    std::uint8_t last = 0;   ///< PRI or INT
    std::uint32_t data = 0;  ///< CRC-32 of the data, which tells it from other data of that size
  };
  std::optional<Trailer> trailer;

  /// Whether both may be sightings or tries of one packet: what both have shown of it is the same.
  bool may_be(const SeenPacket& other) const;
  bool interrupt() const { return wire::code_of(code).interrupt; }
  wire::NodeId seen_by() const { return wire::NodeId{info.input ? info.to : info.from}; }
  /// How far on its way: 0 out of its source, 1 into the next node, 2 out of that ...
  unsigned stage() const { return 2u * hop + (info.input ? 1 : 0); }
  bool home() const { return info.input && info.to == source; }
};

/// Times before 1970 count as 1970.
SeenPacket seen(const CapturedPacket& packet);

}  // namespace limb_ring::capture
