#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/goals.h"
#include "sim/invariants.h"
#include "sim/virtual_line_faults.h"
#include "study/soak_world.h"

namespace limb_ring::study {

/// A ring under random traffic and random faults, all of it decided by the seed: bit errors, lost and cut-off
/// packets, lines that break and heal, delay, stall and duplicate, nodes that die, freeze and come back, CPUs that
/// hang or are reset. Every promise of the ring is checked all the time; afterwards all is mended, and the ring
/// has to be whole again and fall silent.
class RandomFaults {
 public:
  using FoldBack = FoldingRings;
  using World = WorldKind;
  /// What a seed has besides; without it, it gives the run that it always gave.
  struct More {
    const sim::Goal* sought = nullptr;  ///< its strikes are drawn on purpose now and then
    unsigned drift = 0;                 ///< most millionths by which a node's clock is too fast or too slow
    bool clocks = false;                ///< clocks are set, and hosts are suspended
  };
  /// What decides a run.
  struct Origin {
    std::uint64_t seed;
    FoldBack fold_back = FoldBack::some;
    World world = World::usual;
    More more = {};
  };
  /// @pre the world can meet what is sought
  explicit RandomFaults(const Origin& origin);
  explicit RandomFaults(std::uint64_t seed, FoldBack fold_back = FoldBack::some, World world = World::usual)
      : RandomFaults(Origin{seed, fold_back, world, {}}) {}
  const Origin& origin() const { return origin_; }

  /// Runs it all, or until a promise is broken.
  /// @param asked_to_stop asked many times, whatever the ring is at
  /// @return false if it said so: then the run has not ended, and nothing was judged at its end
  bool run(std::function<bool()> asked_to_stop = [] { return false; });
  /// Another future: from that instant on, which is not over, all is drawn by another seed.
  void draw_anew(core::Time from, std::uint64_t seed);
  /// In place of run(): draws nothing, but does some of what another run of the same seed has done, at the same
  /// instants. A slice is hit when it leaves, or in its place the next one.
  /// @param of has kept its history
  /// @param steps of that, in order, maybe at other instants
  /// @param until then all is mended
  /// @param ends whether it goes on from there to its end, as run() does
  void replay(const RandomFaults& of, const std::vector<RecordedStep>& steps, core::Time until, bool ends);
  /// The ring, for further observers before it runs.
  sim::VirtualRing& ring() { return ring_; }
  const std::optional<sim::Violation>& violation() const { return violation_; }

  /// What the seed has chosen, in words.
  std::string describe() const { return world_.describe(); }
  /// From now on all that is done to the ring is kept.
  void keep_history() { history_.keep(); }
  const std::vector<RecordedStep>& history() const { return history_.steps(); }
  /// Until then something was done to it; afterwards all was mended.
  core::Time acted_until() const { return acted_until_; }
  bool paced() const { return world_.paced; }
  bool folds_back() const { return world_.folds_back; }
  /// Results of DATPs and INTPs, by core::Outcome.
  const std::array<unsigned, wire::kOutcomes>& ended() const { return ended_; }
  unsigned nodes() const { return world_.nodes; }
  const core::RingOrder& order() const { return world_.order; }
  std::uint64_t hops() const;
  /// To be called before run().
  void count_goals() { goals_.emplace(ring_); }
  /// How often each goal was met, by place in sim::goals(). @pre they are counted
  std::vector<std::uint64_t> goals_met() const { return goals_->met(); }

 private:
  wire::NodeId random_node() { return world_.order[draws_.below(world_.nodes)]; }
  wire::NodeId random_destination() { return draws_.once_in(5) ? wire::kBroadcast : random_node(); }
  /// Of one step.
  std::chrono::nanoseconds random_while() {
    return std::chrono::nanoseconds(draws_.below(world_.paced ? 12000 : 4000));
  }

  sim::VirtualRingOptions ring_options();
  void tap_all(core::Line line);
  void pass(wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  void act();
  void send();
  void interrupt();
  void fault();
  void burst();
  void storm();
  void seek();
  void seek_by(sim::Strike strike, wire::NodeId node);
  void mend_all();
  void strike(wire::NodeId node);
  void power_cycle(wire::NodeId node);
  void part_or_regroup(wire::NodeId node);
  void line_fault(wire::NodeId node);
  void part(wire::NodeId from, std::size_t nodes);
  void regroup();
  void clock_fault();
  void suspend_or_wake(wire::NodeId node);
  void suspend(wire::NodeId node);
  void stand_still(wire::NodeId node);
  void stand_still(wire::NodeId node, core::Duration lasts);
  void hold_output(wire::NodeId node);
  void hold_output(wire::NodeId node, core::Duration lasts);
  void lose_next(wire::NodeId node);
  void hang_or_go_on(wire::NodeId node);
  void cancel(wire::NodeId node);
  void reset_cpu(wire::NodeId node);
  /// Nanoseconds: that part of the time-out of a try.
  unsigned longest_hold(wire::NodeId node, int share) const;
  core::Duration hold(wire::NodeId node);
  void cut(wire::NodeId node);
  void heal(wire::NodeId node);
  void heal_now(wire::NodeId node) { world_.folds_back ? ring_.heal_cable(node) : ring_.heal(node); }
  void kill_or_start(wire::NodeId node);
  void freeze_or_thaw(wire::NodeId node);
  void bring_back(wire::NodeId node) { killed_[node] ? ring_.start(node) : ring_.thaw(node); }
  void calm_down();
  void check_silence();
  void send_when_mended();
  void run_until_calm();
  bool ends_whole();
  void note_violation();
  core::Duration wait(const std::function<core::Duration()>& draw);
  void pass_again(wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  std::optional<scenario::SoakAction> hit_again(wire::NodeId id, core::Line line);
  void do_again(const std::vector<RecordedStep>& steps, core::Time from, core::Time until);
  void do_again(const scenario::Send& send);
  void do_again(const fault::Fault& fault);
  void do_again(const scenario::SoakAction& action);
  void do_again(const WorldAction& action);
  bool must_stop() { return stopped_ = stopped_ || asked_to_stop_(); }
  bool goes_on() { return !violation_ && !must_stop(); }
  /// A node of a CPU that can ask for sends.
  bool can_ask(wire::NodeId node) const { return ring_.alive(node) && !ring_.paused(node); }

  const Origin origin_;
  bool made_ = false;  ///< ring_ connects its nodes while this is being made
  Draws draws_;
  Draws wide_;  ///< for wide worlds and those in parts alone: seeds of usual ones give the same runs as ever
  const SoakWorld world_;
  Draws sought_draws_;                   ///< for what is sought alone
  const std::vector<int> drifts_;        ///< by id; empty: all clocks are right
  Draws clock_draws_;                    ///< for clocks alone
  std::vector<wire::NodeId> suspended_;  ///< the nodes of a host, until it goes on
  sim::VirtualRing ring_;
  sim::Invariants invariants_;
  std::optional<sim::GoalCounts> goals_;  ///< only if somebody asks
  sim::VirtualLineFaults lines_;
  SoakHistory history_;
  /// Of a run that is done again.
  struct Again {
    struct Hit {
      RecordedStep step;
      unsigned left;  ///< slices until then, that one too
    };
    const RandomFaults& of;
    std::vector<Hit> hits;  ///< slices that are still to be hit
    core::Time instant{core::Duration{-1}};
    std::size_t waits = 0;  ///< drawn in that instant
  };
  std::optional<Again> again_;
  bool quiet_ = false;
  bool parted_ = false;  ///< two hosts do not reach each other
  std::uint64_t slices_when_quiet_ = 0;
  std::vector<bool> killed_;  ///< if not alive: killed (true) or frozen
  std::array<unsigned, wire::kOutcomes> ended_{};
  core::Time acted_until_{};
  std::optional<sim::Violation> violation_;
  std::function<bool()> asked_to_stop_;
  bool stopped_ = false;
};

}  // namespace limb_ring::study
