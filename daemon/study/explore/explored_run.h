#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sim/invariants.h"
#include "sim_tools/virtual_line_faults.h"
#include "study/explore/strike.h"

namespace limb_ring::study {

/// What is explored: a small ring with a few sends.
struct World {
  unsigned nodes = 3;  ///< 2 to 6; 3 at least where it folds back
  unsigned sends = 2;  ///< asked for at once, by one node after another: DATPs to the node before, and broadcasts
  bool paced = true;   ///< lines of 1 Gbit/s, so that packets leave in slices; else whole, at once
  bool fold_back = false;
};

/// One run of that world, with these strikes. It is the same each time. Strikes may fall from when all have joined
/// until every send has ended; then all is mended, and the ring has to be whole again and fall silent.
class ExploredRun {
 public:
  ExploredRun(const World& world, std::vector<Choice> choices);

  /// Runs it all, or until a promise is broken.
  void run();
  /// The ring, for further observers before it runs.
  sim::VirtualRing& ring() { return *ring_; }
  const std::optional<sim::Violation>& violation() const { return violation_; }
  /// At so many places something could have struck.
  unsigned places() const { return places_; }

 private:
  void make_ring();
  void pass(wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  void strike(const Strike& what, wire::NodeId id, core::Line line, const wire::Slice& slice,
              wire::SliceWriter& arriving);
  void damage(std::size_t at, wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  void begin_line_fault(fault::Name name, wire::NodeId id, core::Line line);
  void strike_node(const Strike& what);
  void restart(wire::NodeId node);
  void freeze(wire::NodeId node);
  void cut(wire::NodeId node);
  void ask(unsigned nth);
  void note_violation() { violation_ = invariants_->violation(); }

  World world_;
  std::vector<Choice> choices_;
  std::size_t struck_ = 0;  ///< of choices_
  unsigned places_ = 0;
  unsigned waiting_ = 0;  ///< sends that have not ended
  bool open_ = false;     ///< something may strike
  bool quiet_ = false;
  std::uint64_t slices_when_quiet_ = 0;
  std::unique_ptr<sim::VirtualRing> ring_;
  std::unique_ptr<sim::VirtualLineFaults> lines_;
  std::unique_ptr<sim::Invariants> invariants_;
  std::optional<sim::Violation> violation_;
};

}  // namespace limb_ring::study
