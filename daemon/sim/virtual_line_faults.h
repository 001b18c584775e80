#pragma once

#include <array>
#include <deque>
#include <functional>
#include <optional>

#include "config/line_faults.h"
#include "judge/promise.h"
#include "sim/invariants.h"
#include "sim/virtual_ring.h"

namespace limb_ring::sim {

/// Faults on the lines of a virtual ring: takes them down and up, and puts onto them later what they hold back.
class VirtualLineFaults : public Observer {
 public:
  /// @param ring must outlive this, and never runs without it. @param seed of whatever is random
  VirtualLineFaults(VirtualRing& ring, std::uint64_t seed);
  VirtualLineFaults(const VirtualLineFaults&) = delete;
  VirtualLineFaults& operator=(const VirtualLineFaults&) = delete;

  /// Lays a tap on every line of the ring.
  void tap_all();
  /// On the line out of one node: without a tap a fault hits nothing.
  void tap(wire::NodeId id, core::Line line);
  /// On each line out of the fault's nodes. @pre it is of a line
  void begin(const fault::Fault& fault);
  /// @name On the line out of one node, as in fault::LineFaults
  ///@{
  fault::LineFaults::Id begin(wire::NodeId id, core::Line line, const fault::Fault& fault);
  bool remove(wire::NodeId id, core::Line line, fault::LineFaults::Id fault);
  void clear(wire::NodeId id, core::Line line);
  std::vector<fault::LineFaults::Listed> list(wire::NodeId id, core::Line line);
  const fault::LineCounters& counters(wire::NodeId id, core::Line line) const;
  bool cut(wire::NodeId id, core::Line line) const { return lines_[static_cast<std::size_t>(line)][id].cut; }
  ///@}
  /// No line has a fault, holds anything back, or will be looked at again.
  bool at_rest() const;
  /// Ends all on all lines.
  void mend_all();

  /// For a tap of the caller's own: what comes out of the line now.
  void pass(wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  /// The same, with these bits of one byte flipped. @pre at < slice.bytes.size
  void pass_damaged(wire::NodeId id, core::Line line, const wire::Slice& slice, std::size_t at, std::uint8_t bits,
                    wire::SliceWriter& arriving);
  void incident(wire::NodeId id, Incident incident, core::Time now, core::Line line) override;

 private:
  struct Wire {
    Wire(std::uint64_t seed, core::Duration byte_time) : faults(seed, byte_time) {}
    fault::LineFaults faults;
    bool cut = false;                ///< by a fault
    core::Time wake = core::kNever;  ///< of the next poll()
  };
  Wire& wire_of(wire::NodeId id, core::Line line) { return lines_[static_cast<std::size_t>(line)][id]; }
  template <class Each>
  void each_line(Each each) const {
    for (const core::Line line : ring_.lines())
      for (std::size_t id = 0; id < lines_[static_cast<std::size_t>(line)].size(); ++id)
        each(static_cast<wire::NodeId>(id), line);
  }
  void poll(wire::NodeId id, core::Line line);
  void poll_later(wire::NodeId id, core::Line line);
  void cut_line(wire::NodeId id, core::Line line);

  VirtualRing& ring_;
  std::array<std::deque<Wire>, 2> lines_;  ///< out of each node, by Line; no second ones without fold-back
  wire::SliceWriter late_;
};

/// Times and buffers of rings that are given faults: short and few, so that every limit is met soon.
/// @param paced lines have a rate
void set_short_times(core::Settings& settings, bool paced, bool fold_back);

/// Whether a slice counts as traffic: it does not belong to a beacon. The beginning of a packet never counts, since
/// only its end shows what it is.
bool is_traffic(const wire::Slice& slice);

/// Runs a ring in which all was mended until what is left over has ended: all nodes are up in a ring of them all, each
/// send has its result, and nothing but beacons has passed for ten of their periods, and for longer than the tries of a
/// send take. What does not end is for not_whole(), not_silent() and Invariants::finish() to tell.
/// @param traffic slices of it that were seen so far
/// @param asked_to_stop asked once in each millisecond of the ring's time; true: it runs no longer
void run_until_calm(
    VirtualRing& ring, const Invariants& invariants, const std::uint64_t& traffic,
    const std::function<bool()>& asked_to_stop = [] { return false; });

/// All was mended some time ago: nothing if all nodes are up in a ring of them all.
std::optional<Violation> not_whole(VirtualRing& ring);
/// Traffic has ended long ago: whatever still goes round, and is not a beacon, would do so for ever.
/// @param slices of traffic that were seen since
std::optional<Violation> not_silent(const VirtualRing& ring, std::uint64_t slices);

}  // namespace limb_ring::sim
