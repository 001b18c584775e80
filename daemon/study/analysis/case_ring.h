#pragma once

#include "sim/trace.h"
#include "sim/watched_ring.h"
#include "study/analysis/medium.h"

namespace limb_ring::study {

/// What the lines are used for.
class LineUse : public sim::Observer {
 public:
  explicit LineUse(sim::VirtualRing& ring) : going_(ring.size()) { ring.add_observer(*this); }
  void leaves(NodeId node, const wire::Slice& slice, Time) override {
    bytes_ += slice.bytes.size;
    if (slice.kind == wire::SliceKind::interrupt) return;
    if (slice.kind == wire::SliceKind::start || slice.kind == wire::SliceKind::whole) going_[node] = 0;
    going_[node] += slice.bytes.size;
    if (slice.kind != wire::SliceKind::end && slice.kind != wire::SliceKind::whole) return;
    packet_bytes_ += going_[node];
    data_bytes_ += going_[node] - wire::kOverhead;
  }
  std::uint64_t bytes() const { return bytes_; }
  /// Of whole DATPs, and what of them was data.
  std::uint64_t packet_bytes() const { return packet_bytes_; }
  std::uint64_t data_bytes() const { return data_bytes_; }

 private:
  std::vector<std::size_t> going_;  ///< bytes of the DATP on each line
  std::uint64_t bytes_ = 0, packet_bytes_ = 0, data_bytes_ = 0;
};

/// A ring as protocol.md section 7.2 supposes it: joined before time zero, beacons and time-outs off.
class CaseRing : public sim::WatchedRing {
 public:
  CaseRing(const Medium& medium, std::ostream* trace);

  /// When the ring had joined and was quiet: time zero of the case.
  Time zero() const { return zero_; }
  std::uint64_t trace_hash() const { return trace_.hash(); }
  /// Share of the time since `since` in which the lines were in use. @param bytes what LineUse had counted at `since`
  double occupancy(Time since, std::uint64_t bytes) const;
  const LineUse& line_use() const { return line_use_; }

 private:
  Medium medium_;
  sim::Trace trace_;
  LineUse line_use_;
  Time zero_{};
};

}  // namespace limb_ring::study
