#pragma once

#include <optional>
#include <random>
#include <vector>

#include "sim/virtual_ring.h"
#include "study/scenario/scenario.h"

namespace limb_ring::study::scenario {

/// What happens to packets on the lines of a virtual ring: drop, corrupt, truncate. A packet is hit whole,
/// however many slices it travels in; an INTP inside a DATP is a packet of its own.
class LineFaults {
 public:
  LineFaults(sim::VirtualRing& ring, std::uint64_t seed) : ring_(ring), random_(seed), lines_(ring.size()) {}
  LineFaults(const LineFaults&) = delete;
  LineFaults& operator=(const LineFaults&) = delete;

  /// @pre one of drop, corrupt, truncate
  void begin(const Fault& fault);
  /// Ends all on the line out of that node.
  void end(NodeId line) { lines_[line].active.clear(); }

 private:
  struct Active {
    FaultName name;
    std::uint64_t left;  ///< packets
    std::uint64_t once_in;
    core::Time until;
  };
  struct Line {
    std::vector<Active> active;
    std::optional<FaultName> on_data;  ///< what happens to the DATP that is passing
  };

  std::optional<FaultName> decide(Line& line, bool interrupt);
  void pass(NodeId id, const wire::Slice& slice, wire::SliceWriter& arriving);
  void damage(const wire::Slice& slice, wire::SliceWriter& arriving);

  sim::VirtualRing& ring_;
  std::mt19937_64 random_;
  std::vector<Line> lines_;
};

}  // namespace limb_ring::study::scenario
