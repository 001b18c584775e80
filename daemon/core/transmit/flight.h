#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/time.h"
#include "wire/packet.h"

namespace limb_ring::core {

/// The one packet of its kind that a node has outstanding: its image, its tries, its time-out.
/// A node does not send its next packet until the last one is back. (paper) Time-out and retries
/// are ours.
class Flight {
 public:
  enum class Phase { idle, waiting, out };  ///< waiting: for the line, before a try

  Phase phase() const { return phase_; }
  bool idle() const { return phase_ == Phase::idle; }
  Time waiting_since() const { return since_; }
  Time deadline() const { return phase_ == Phase::out ? deadline_ : kNever; }
  Time sent_at() const { return sent_at_; }
  wire::ByteView image() const { return {bytes_->data(), size_}; }
  wire::NodeId destination() const { return wire::PacketFields{image()}.destination(); }

  /// A new packet, which goes onto the line at once; the caller writes `data_size` bytes where the result points.
  std::uint8_t* load(wire::Code code, wire::NodeId source, wire::NodeId destination, std::uint8_t last,
                     std::size_t data_size);
  /// Its next try goes onto the line now.
  wire::ByteView launch(Time now, Duration timeout);
  /// True where `packet` is what was sent last: Code, DID, last field, size, and the data through
  /// the CRC with HOP and FBC put back. (ours, protocol.md section 4.2) @pre its CRC is good
  bool is_return(const wire::PacketFields& packet) const;
  /// A try has failed. @return false where no more are left
  bool retry(Time now);
  void clear() { phase_ = Phase::idle; }
  /// archive.h
  template <class Archive>
  void archive(Archive& a) {
    a("phase", phase_)("interrupt", code_.interrupt)("attempt", code_.attempt)("sequence", code_.sequence);
    a("incarnation", code_.incarnation)("since", since_)("sent_at", sent_at_)("deadline", deadline_);
    a("size", size_)("bytes", *bytes_, size_);
  }

 private:
  Phase phase_ = Phase::idle;
  wire::Code code_;
  Time since_{};
  Time sent_at_{};  ///< first byte of the last try
  Time deadline_{};
  std::size_t size_ = 0;
  using Bytes = std::array<std::uint8_t, wire::kMaxDataPacketSize>;
  std::unique_ptr<Bytes> bytes_ = std::make_unique<Bytes>();  ///< on the heap: kept away from what every hop reads
};

}  // namespace limb_ring::core
