#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "sim/invariants.h"
#include "sim/virtual_line_faults.h"
#include "study/explore/known_states.h"
#include "study/explore/strike.h"

namespace limb_ring::study {

/// What is explored: a small ring with a few sends.
struct World {
  unsigned nodes = 3;  ///< 2 to 6; 3 at least where it folds back
  unsigned sends = 2;  ///< asked for at once, by one node after another: DATPs to the node before, and broadcasts
  bool paced = true;   ///< lines of 1 Gbit/s, so that packets leave in slices; else whole, at once
  bool fold_back = false;
  /// The line out of the last node is cut before the sends and mended at the end, so the ring is an open chain. With
  /// fold_back the whole cable there is cut, so the ring is folded.
  bool broken = false;

  static constexpr unsigned kMostNodes = 6;
  wire::NodeId last_node() const { return static_cast<wire::NodeId>(nodes - 1); }
};

/// One run of a world with given strikes; it is the same each time. The window for strikes opens when all nodes have
/// joined, and closes when every send has ended and the ring is as it was at the beginning. Then all is mended, and
/// the ring has to be whole and fall silent.
class ExploredRun {
 public:
  ExploredRun(const World& world, std::vector<Choice> choices);

  /// Lets the run end when it reaches a state of another run. This is checked once all has struck: when the window has
  /// closed, and if `left` is not 0 also before. @param states must outlive it
  /// @param left how many more may strike in runs that begin like this one
  void recognise(KnownStates& states, std::uint64_t run, unsigned left) {
    states_ = &states;
    run_ = run;
    left_ = left;
  }
  /// It ended in a state of another run.
  bool recognised() const { return recognised_; }

  /// Runs it all, or until a promise is broken.
  void run();
  /// The ring, for further observers before it runs.
  sim::VirtualRing& ring() { return *ring_; }
  const std::optional<sim::Violation>& violation() const { return violation_; }
  /// The number of places at which something could have struck.
  unsigned places() const { return places_; }

 private:
  /// What a freeze or a cut ends with.
  struct Mending {
    core::Time at;
    Strike::Kind of;
    wire::NodeId node;

    template <class Archive>
    void archive(Archive& a) {
      a("at", at)("of", of)("node", node);
    }
  };

  void make_ring();
  void break_ring();
  bool meets_known_state();
  std::uint64_t state_hash();
  bool is_over();
  bool is_settled() const;
  void settle_later();
  void pass(wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  void strike(const Strike& what, wire::NodeId id, core::Line line, const wire::Slice& slice,
              wire::SliceWriter& arriving);
  void damage(std::size_t at, wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  void begin_line_fault(fault::Name name, wire::NodeId id, core::Line line);
  void strike_node(const Strike& what);
  void restart(wire::NodeId node);
  void freeze(wire::NodeId node);
  void cut(wire::NodeId node);
  void heal(wire::NodeId node);
  void mend_later(Strike::Kind of, wire::NodeId node);
  void mend();
  void ask(unsigned nth);
  void note_violation() { violation_ = invariants_->violation(); }

  World world_;
  std::vector<Choice> choices_;
  std::size_t struck_ = 0;    ///< of choices_
  bool strikes_now_ = false;  ///< the last strike is of a node, and comes once the slice is on its way
  unsigned places_ = 0;
  std::array<unsigned, World::kMostNodes> waiting_{};  ///< sends of each node that have not ended
  std::deque<Mending> mendings_;                       ///< that are still to come
  core::Time settled_by_ = core::kNever;               ///< all know how the ring is, or wait for its mending
  bool open_ = false;                                  ///< something may strike
  bool quiet_ = false;
  std::uint64_t slices_when_quiet_ = 0;
  std::unique_ptr<sim::VirtualRing> ring_;
  std::unique_ptr<sim::VirtualLineFaults> lines_;
  std::unique_ptr<sim::Invariants> invariants_;
  std::optional<sim::Violation> violation_;
  KnownStates* states_ = nullptr;
  std::uint64_t run_ = 0;
  unsigned left_ = 0;
  unsigned compared_at_ = 0;  ///< so many places had passed then
  bool recognised_ = false;
};

}  // namespace limb_ring::study
