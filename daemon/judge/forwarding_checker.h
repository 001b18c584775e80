#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>

#include "core/network_controller.h"
#include "core/time.h"
#include "judge/promise.h"
#include "wire/slice.h"

namespace limb_ring::sim {

using core::Duration;
using core::Time;
using wire::NodeId;

/// The header of a packet on a line.
struct PacketHeader {
  wire::Code code;
  std::uint8_t code_byte = 0, hop = 0;
  NodeId source{0};

  static PacketHeader of(wire::ByteView bytes) {
    const wire::PacketFields packet{bytes};
    return {packet.code(), packet.code_byte(), packet.hop(), packet.source()};
  }
  /// Without `code`, which code_byte holds, too.
  template <class Archive>
  void archive(Archive& a) {
    a("code_byte", code_byte)("hop", hop)("source", source);
  }
};

/// The trailer and the CRC of a packet on a line.
struct PacketTrailer {
  std::uint8_t fbc = 0;
  NodeId destination{0};
  std::uint8_t last = 0;
  std::uint32_t crc = 0;

  static PacketTrailer of(wire::ByteView bytes) {
    const wire::PacketFields packet{bytes};
    return {packet.fbc(), packet.destination(), packet.last(), packet.crc()};
  }
  /// The CRC of a packet of `size` bytes as it was at its source: it tells packets apart.
  std::uint32_t crc_at_source(const PacketHeader& header, std::size_t size) const {
    return wire::carried_crc(crc, size, header.hop, fbc ^ wire::kFbcUntaken);
  }
};

/// What has come into one node and has to go on. Checks that it does with the right FBC, and an INTP in time.
class ForwardingChecker {
 public:
  /// @param byte_time,byte_time_in of the lines out of it and into it
  ForwardingChecker(NodeId id, Duration byte_time, Duration byte_time_in, const Complain& complain)
      : id_(id),
        byte_time_(byte_time),
        lag_(std::max(Duration{0}, byte_time_in - byte_time) * static_cast<std::int64_t>(wire::kInterruptPacketSize)),
        complain_(complain) {}

  /// The FBC that a packet has to leave with.
  struct Due {
    int fbc;                              ///< kAnyFbc: it cannot be told from outside
    Promise promise = Promise::true_fbc;  ///< the one that is broken if it leaves with another FBC
    bool good = true;                     ///< its CRC is right

    template <class Archive>
    void archive(Archive& a) {
      a("fbc", fbc)("promise", promise)("good", good);
    }
  };
  static constexpr int kAnyFbc = -1;
  /// A packet of another node has come in, of `size` bytes.
  void came(const PacketHeader& header, NodeId destination, Due due, std::size_t size, Time now);
  /// `size` bytes of a DATP have come in, and no more of it will.
  void broke_off(std::size_t size, Time now) {
    came({{}, 0, 0, wire::kBroadcast}, wire::kBroadcast, {kAnyFbc}, size, now);
  }
  /// Bytes of all DATPs that have come in and not left: the node holds no more than that.
  std::size_t bytes() const { return bytes_; }
  /// The same of those that have come in at `since` or later.
  std::size_t bytes_since(Time since) const;
  /// A packet of another node leaves.
  /// @return true if it had come in good, or nobody knows
  bool went(const PacketHeader& header, const PacketTrailer& tail, Time now);
  /// One of its own INTPs leaves that could have left since `since`.
  void own_interrupt_went(Time since, Time now);
  /// An INTP leaves, own or not: others may have to wait for it.
  void count_interrupt(Time now);
  /// The output took nothing until now, or the node stood still.
  void released(Time now) { released_ = now; }
  void clear();
  template <class Archive>
  void archive(Archive& a) {
    a("data", data_)("interrupts", interrupts_)("bytes", bytes_)("released", released_);
    a("interrupts_gone", interrupts_gone_);
  }

 private:
  struct Coming {
    std::uint8_t code_byte;
    NodeId source, destination;
    Due due;
    std::size_t size;
    Time at;

    template <class Archive>
    void archive(Archive& a) {
      a("code_byte", code_byte)("source", source)("destination", destination)("due", due)("size", size)("at", at);
    }
  };
  void check_wait(Time since, Time now, const Words& which) const;

  NodeId id_;
  Duration byte_time_;  ///< of the line out of it
  Duration lag_;        ///< an INTP from a slower line begins so much later, lest it end before it has come in
  const Complain& complain_;
  std::deque<Coming> data_, interrupts_;
  std::size_t bytes_ = 0;  ///< of data_
  Time released_{};
  std::deque<Time> interrupts_gone_;  ///< when the last ones left, in order of time
};

/// Puts the DATP together whose slices pass, as a receiver does: one that breaks off, stalls or is too long is dropped.
/// (protocol.md section 2.6)
class PacketCollector {
 public:
  /// @param stall the longest pause between two slices of a DATP
  explicit PacketCollector(core::Duration stall) : stall_(stall) {}

  bool open() const { return open_; }
  /// Bytes of the DATP that have come in; also after it was broken off, or is whole.
  std::size_t size() const { return size_; }
  void drop() { open_ = false; }
  /// True if the DATP is given up by now. A slice in the very instant at which it would be still belongs to it.
  bool stalled(core::Time now) const { return open_ && last_ + stall_ < now; }

  template <class Archive>
  void archive(Archive& a) {
    a("open", open_)("size", size_)("last", last_)("bytes", bytes_, open_ ? size_ : 0);
  }

  /// @return the packet if this slice is its end, valid until the next one; else nothing
  wire::ByteView put(const wire::Slice& slice, core::Time now) {
    using wire::SliceKind;
    if (slice.kind == SliceKind::whole) return size_ = slice.bytes.size, open_ = false, slice.bytes;
    if (slice.kind == SliceKind::abort) return open_ = false, wire::ByteView{};
    const bool begins = slice.kind == SliceKind::start;
    if (begins) size_ = 0;
    if (!begins && (!open_ || (slice.kind != SliceKind::more && slice.kind != SliceKind::end))) return {};
    const bool ends = slice.kind == SliceKind::end;
    const std::size_t most = ends ? wire::kMaxDataPacketSize : wire::kHeaderSize + wire::kMaxPayload;
    open_ = size_ + slice.bytes.size <= most;
    if (!open_) return {};
    std::memcpy(bytes_.data() + size_, slice.bytes.data, slice.bytes.size);
    size_ += slice.bytes.size;
    last_ = now;
    if (!ends) return {};
    open_ = false;
    return size_ < wire::kMinDataPacketSize ? wire::ByteView{} : wire::ByteView{bytes_.data(), size_};
  }

 private:
  core::Duration stall_;
  bool open_ = false;
  std::size_t size_ = 0;
  core::Time last_{};
  std::array<std::uint8_t, wire::kMaxDataPacketSize> bytes_;
};

}  // namespace limb_ring::sim
