#pragma once

#include <array>
#include <cstdint>

#include "core/slot_queue.h"
#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::core {

/// A DATP that Relay has handed to the Packet Manager, perhaps still coming in.
struct RelayedPacket {
  enum class State : std::uint8_t { receiving, complete, aborted } state = State::receiving;
  Time arrived{};          ///< when its header came in: decides the order
  Time tail_at{};          ///< when its end came in
  std::uint16_t size = 0;  ///< bytes that have come in
  std::array<std::uint8_t, wire::kMaxDataPacketSize> bytes;

  template <class Archive>
  void archive(Archive& a) {
    a("state", state)("arrived", arrived)("tail_at", tail_at)("size", size)("bytes", bytes, size);
  }
};

/// Where relayed DATPs wait while the line is taken (paper: "the other waits in a buffer").
/// Bounded in bytes: room for one DATP of the largest size is enough while nothing is lost and the output is no slower
/// than the input, also for many small ones; each further copy of an own packet in flight adds one. Before a slower
/// output, or if packets come late, one of each other node may wait. (ours, protocol.md section 2.5)
class InsertionBuffer {
 public:
  /// @param capacity DATPs of the largest size
  explicit InsertionBuffer(unsigned capacity) : most_bytes_(capacity * wire::kMaxDataPacketSize) {}

  bool empty() const { return packets_.empty(); }
  /// No room for a DATP of the largest size: how long one will be is not known when it begins.
  bool full() const { return bytes_ + wire::kMaxDataPacketSize > most_bytes_; }
  std::size_t count() const { return packets_.size(); }
  /// Bytes of all packets in it, with those of the front one that have left already.
  std::size_t bytes() const { return bytes_; }
  RelayedPacket& front() { return packets_.front(); }
  const RelayedPacket& front() const { return packets_.front(); }
  RelayedPacket& back() { return packets_[packets_.size() - 1]; }
  /// @pre !full()
  RelayedPacket& push(Time now) {
    RelayedPacket& slot = packets_.push();
    slot.state = RelayedPacket::State::receiving;
    slot.arrived = slot.tail_at = now;  // nothing of the slot's last packet stays: replays compare it
    slot.size = 0;
    return slot;
  }
  /// `bytes` more bytes of the last packet have come in.
  void grow(std::size_t bytes) {
    back().size = static_cast<std::uint16_t>(back().size + bytes);
    bytes_ += bytes;
  }
  void pop() {
    bytes_ -= front().size;
    packets_.pop();
  }
  void pop_back() {
    bytes_ -= back().size;
    packets_.pop_back();
  }
  void clear() {
    packets_.clear();
    bytes_ = 0;
  }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("bytes", bytes_)("packets", packets_);
  }

 private:
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  SlotQueue<RelayedPacket> packets_;
};

}  // namespace limb_ring::core
