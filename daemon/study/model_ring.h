#pragma once

#include <cstdint>
#include <vector>

#include "core/time.h"
#include "judge/percentiles.h"
#include "sim/planned_ring.h"
#include "sim/virtual_ring.h"
#include "wire/packet.h"

namespace limb_ring::study {

using core::Duration;
using core::Time;
using wire::NodeId;

/// What a network is built of: the same figures for every method that is compared.
struct Medium {
  unsigned nodes = 16;                           ///< 2 to 254
  std::uint64_t rate = sim::kUsualRate;          ///< R, bit/s
  Duration relay_delay = sim::kUsualRelayDelay;  ///< d: line and node, once per hop
  unsigned payload = wire::kMaxPayload;          ///< B, bytes of data in a message, 1 to 512

  /// Time of one byte on the line, rounded to whole picoseconds.
  Duration byte_time() const { return bits(8); }
  /// Time of so many bits on the line, rounded to whole picoseconds.
  Duration bits(std::uint64_t count) const {
    const auto picoseconds = static_cast<long double>(count) * 1'000'000'000'000 + rate / 2;
    return Duration{static_cast<std::int64_t>(picoseconds / rate)};
  }
};

}  // namespace limb_ring::study

/// The ring of the paper's model (protocol.md section 7.2): our core on a medium, without what that model lacks.

namespace limb_ring::study {

/// A virtual ring on that medium, beacons off. Its time-outs are those of the model, two worst laps; it
/// meets no other limit. (ours)
sim::VirtualRingOptions ring_options(const Medium& medium);

/// Runs until every living node has joined. @throw std::runtime_error if the ring does not close
void join(sim::VirtualRing& ring);

/// The same, and until the line is quiet again.
void join_and_settle(sim::VirtualRing& ring, const Medium& medium);

// What our ring promises while nothing is lost. (protocol.md section 7.2)

/// T: a whole DATP of the medium's payload on the line.
inline Duration packet_time(const Medium& medium) {
  return medium.byte_time() * static_cast<std::int64_t>(medium.payload + wire::kOverhead);
}

/// An INTP on the line.
inline Duration interrupt_time(const Medium& medium) {
  return medium.byte_time() * static_cast<std::int64_t>(wire::kInterruptPacketSize);
}

/// A DATP, from the start of sending until its tail is in so many hops further, if no INTP is under
/// way: h (T + d).
inline Duration data_bound(const Medium& medium, unsigned hops) {
  return hops * (packet_time(medium) + medium.relay_delay);
}

/// An INTP, from the CPU's request until it is back: at every node behind one INTP of its own and the
/// odd bytes, trailer and CRC of a DATP. All DATPs have the medium's payload.
inline Duration interrupt_bound(const Medium& medium) {
  const std::size_t tail = wire::tail_size(wire::kOverhead + medium.payload);
  const Duration wait = medium.byte_time() * static_cast<std::int64_t>(tail);
  return medium.nodes * (medium.relay_delay + interrupt_time(medium) + wait);
}

/// The same if INTPs are not embedded: at every node behind a whole DATP instead. (ours)
inline Duration interrupt_bound_between_packets(const Medium& medium) {
  return medium.nodes * (medium.relay_delay + interrupt_time(medium) + packet_time(medium));
}

/// Latencies of one kind, all kept.
class Latencies {
 public:
  void add(Duration latency) {
    values_.push_back(latency);
    sorted_ = false;
  }
  std::size_t count() const { return values_.size(); }
  /// @name Zero if there is none.
  ///@{
  Duration min() const { return quantile(0); }
  Duration max() const { return quantile(1); }
  Duration mean() const;
  /// The smallest value that at least this share of all does not exceed (nearest rank).
  Duration quantile(double share) const;
  ///@}
  const std::vector<Duration>& values() const { return values_; }

 private:
  mutable std::vector<Duration> values_;
  mutable bool sorted_ = true;
};

using statistics::microseconds;

}  // namespace limb_ring::study
