#pragma once

#include <cstdint>
#include <functional>
#include <ostream>
#include <string>

#include "sim/invariants.h"
#include "sim/planned_ring.h"
#include "sim/trace.h"
#include "sim/virtual_ring.h"
#include "study/model_ring.h"

namespace limb_ring::study {

/// The cases of protocol.md section 7.2, each on the real core under a virtual clock: the ring has
/// joined before time zero and beacons are off. T = (B + 12) bytes on the line, i = 12 bytes.
enum class Case {
  alone,            ///< one packet, nobody else sends: T + N d
  simultaneous,     ///< all start at the same instant: N T + d, or T + N d if T < d
  adversarial,      ///< each node starts its own just before this one arrives: N (T + d)
  request,          ///< the same, asked for just after a packet of another began to pass: (N + 1) T + N d
  delivery,         ///< adversarial, to the farthest node: (N - 1) (T + d)
  interrupt,        ///< an INTP behind one other at every node: N (d + i)
  interrupt_bound,  ///< worst seen under full load; behind trailer and CRC as well: N (d + i + 8 bytes)
  saturated,        ///< all always send, aligned: occupancy of the lines, N T / (N T + d)
  random,           ///< all always send, at random phases: bound N (T + d)
  payload           ///< share of the bytes on the lines that are data, all always sending: B / (B + 12)
};
constexpr Case kCases[] = {Case::alone,     Case::simultaneous,    Case::adversarial, Case::request, Case::delivery,
                           Case::interrupt, Case::interrupt_bound, Case::saturated,   Case::random,  Case::payload};
const char* to_string(Case which);
/// The formula in words: "N (T + d)".
std::string formula_words(Case which, const Medium& medium);

struct CaseResult {
  Duration formula{0};     ///< of the time; a bound in `interrupt_bound` and `random`
  Latencies measured;      ///< of the packets in question, one or many
  bool has_share = false;  ///< saturated, payload: a share instead of a time
  double formula_share = 0, measured_share = 0;
  double occupancy = 0;  ///< of all lines, while it ran
  std::uint64_t trace_hash = 0;
};

/// Who hears of a case: where it writes what happens on its lines, and whom it tells that it goes on. Streams are null
/// if nobody wants to read that.
struct CaseRecords {
  std::ostream* trace = nullptr;    ///< lines of text (sim/trace.h)
  std::ostream* capture = nullptr;  ///< packets, as pcapng
  sim::CaptureAt capture_at = sim::CaptureAt::inputs;
  std::function<void()> goes_on = [] {};  ///< called every 4096 slices
};

/// Runs one case. The seed matters if something is random (interrupt_bound, random).
/// @throw sim::BrokenPromise
CaseResult run_case(Case which, const Medium& medium, std::uint64_t seed, const CaseRecords& records = {});

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

/// Tells now and then that a ring goes on: every 4096 slices.
class Pulse : public sim::Observer {
 public:
  Pulse(sim::VirtualRing& ring, const std::function<void()>& goes_on) : goes_on_(goes_on) { ring.add_observer(*this); }
  void leaves(NodeId, const wire::Slice&, Time) override {
    if (++slices_ % 4096 == 0) goes_on_();
  }

 private:
  const std::function<void()>& goes_on_;
  std::uint64_t slices_ = 0;
};

}  // namespace limb_ring::study
