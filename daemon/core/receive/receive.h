#pragma once

#include <array>

#include "core/counters.h"
#include "core/events.h"
#include "core/membership/membership.h"
#include "core/receive/duplicate_memory.h"
#include "core/settings.h"
#include "core/slot_queue.h"
#include "wire/packet.h"

namespace limb_ring::core {

/// The interrupt pins of the NC: an INTP addressed to this node pulls the pin of its number, no
/// firmware involved. (paper) Only after a good CRC, and once per INTP. (ours, protocol.md section 5.3)
class Pins {
 public:
  Pins(const Settings& settings, DuplicateMemory& memory, Membership& membership, Counters& counters,
       EventQueue& events)
      : settings_(settings), memory_(memory), membership_(membership), counters_(counters), events_(events) {}

  /// An INTP of another node, with a good CRC, passes.
  /// @return the FBC it goes on with: 1 pin pulled, 0 pin wired to nothing
  std::uint8_t pass(const wire::PacketFields& packet, Time at) {
    return membership_.is_unheard_nodes_retry(packet) ? packet.fbc() : offer(packet, at);
  }
  /// The part of pass() that applies to an own INTP to this node, too. @param at when its last bit is in
  std::uint8_t offer(const wire::PacketFields& packet, Time at);

 private:
  using Verdict = DuplicateMemory::Verdict;
  bool addressed(const wire::PacketFields& packet) const;
  bool pull(const wire::PacketFields& packet, Time at);

  const Settings& settings_;
  DuplicateMemory& memory_;
  Membership& membership_;
  Counters& counters_;
  EventQueue& events_;
};

/// A DATP in a receive buffer, for the CPU.
struct ReceivedPacket {
  Time at{};  ///< its last bit was in
  NodeId source{0};
  NodeId destination{0};  ///< this node, or wire::kBroadcast
  wire::Priority priority{};
  wire::ChannelId channel{};
  std::uint16_t size = 0;  ///< 1..512
  std::array<std::uint8_t, wire::kMaxPayload> data;

  wire::ByteView bytes() const { return {data.data(), size}; }

  template <class Archive>
  void archive(Archive& a) {
    a("at", at)("source", source)("destination", destination)("priority", priority)("channel", channel);
    a("size", size)("data", data, size);
  }
};

/// Receive: works in parallel with Relay on the same input, takes packets addressed to this node
/// or broadcast, by priority, and ignores the rest. (paper) Verdicts and exactly once are ours (protocol.md sections
/// 2.3 and 4.10).
class Receive {
 public:
  Receive(const Settings& settings, DuplicateMemory& memory, Membership& membership, Counters& counters)
      : settings_(settings), memory_(memory), membership_(membership), counters_(counters) {}

  /// The node takes something from that packet. Of others pass() only counts some.
  bool heeds(const wire::PacketFields& packet) const { return addressed(packet) || wire::is_control(packet); }
  /// A packet of another node, with a good CRC, passes.
  /// @return the FBC it goes on with
  std::uint8_t pass(const wire::PacketFields& packet, Time at) {
    if (heeds(packet)) return take_in(packet, at);
    membership_.is_unheard_nodes_retry(packet);  // counts it
    return packet.fbc();
  }
  /// The part of pass() that applies to an own packet to this node, too. @param at when its last bit is in
  std::uint8_t offer(const wire::PacketFields& packet, Time at);

  /// The next packet for the CPU, highest priority first. @return false if none is there yet
  bool take(Time now, ReceivedPacket& out) { return waiting_ != 0 && take_due(now, out); }
  std::size_t waiting() const { return waiting_; }
  /// The same of one priority, 0..3.
  std::size_t waiting(wire::Priority priority) const { return buffers_[priority].size(); }
  /// take() has something.
  bool is_due(Time now) const { return waiting_ != 0 && earliest() <= now; }
  /// When take() may have something, kNever if all buffers are empty.
  Time next() const { return waiting_ == 0 ? kNever : earliest(); }

  void set_cpu_present(bool present) { cpu_present_ = present; }
  /// The CPU was reset: the buffers are emptied, so that it acts on no stale command.
  void flush();
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("buffers", buffers_)("waiting", waiting_)("cpu_present", cpu_present_);
  }

 private:
  using Verdict = DuplicateMemory::Verdict;
  bool addressed(const wire::PacketFields& packet) const {
    if (packet.destination() == wire::kBroadcast) return packet.source() != settings_.id;
    return packet.destination() == settings_.id;
  }
  std::uint8_t take_in(const wire::PacketFields& packet, Time at);
  bool take_due(Time now, ReceivedPacket& out);
  Time earliest() const;
  std::size_t free_buffers(const wire::PacketFields& packet) const;
  bool accepts(const wire::PacketFields& packet);
  void store(const wire::PacketFields& packet, Time at);

  const Settings& settings_;
  DuplicateMemory& memory_;
  Membership& membership_;
  Counters& counters_;
  std::size_t waiting_ = 0;  ///< in all buffers
  bool cpu_present_ = false;
  std::array<SlotQueue<ReceivedPacket>, 4> buffers_;
};

}  // namespace limb_ring::core
