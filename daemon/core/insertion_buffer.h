#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/time.h"
#include "wire/data_packet.h"

namespace limb_ring::core {

/// A DATP that Relay has handed to the Packet Manager, perhaps still coming in.
struct RelayedPacket {
  enum class State : std::uint8_t { receiving, complete, aborted } state = State::receiving;
  Time arrived{};             ///< its header came in: its place in the order
  Time tail_at{};             ///< its end came in
  std::uint8_t hop_before = 0;
  std::uint16_t size = 0;     ///< bytes that have come in
  std::array<std::uint8_t, wire::kMaxDataPacketSize> bytes;

  void append(wire::ByteView more) {
    std::memcpy(bytes.data() + size, more.data, more.size);
    size = static_cast<std::uint16_t>(size + more.size);
  }
};

/// Where relayed DATPs wait while the line is taken (paper: "the other waits in a buffer").
/// Bounded: one is enough while nothing is lost, and each copy of an own packet in flight adds
/// one. (ours, protocol.md section 2)
class InsertionBuffer {
 public:
  explicit InsertionBuffer(unsigned capacity) : slots_(capacity) {}

  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == slots_.size(); }
  std::size_t count() const { return count_; }
  RelayedPacket& front() { return slots_[first_]; }
  const RelayedPacket& front() const { return slots_[first_]; }
  RelayedPacket& back() { return slots_[(first_ + count_ - 1) % slots_.size()]; }
  /// @pre !full()
  RelayedPacket& push(Time now) {
    ++count_;
    RelayedPacket& slot = back();
    slot.state = RelayedPacket::State::receiving;
    slot.arrived = now;
    slot.size = 0;
    return slot;
  }
  void pop() {
    --count_;
    first_ = count_ == 0 ? 0 : (first_ + 1) % slots_.size();  // an empty one goes on with the slot still in cache
  }
  void clear() { count_ = 0; }

 private:
  std::vector<RelayedPacket> slots_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace limb_ring::core
