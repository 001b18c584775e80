#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sim/invariants.h"
#include "sim_tools/virtual_line_faults.h"
#include "study/soak/recorded_step.h"

namespace limb_ring::study {

/// A ring under random traffic and random faults, all of it decided by the seed: bit errors, lost and cut-off
/// packets, lines that break and heal, delay, stall and duplicate, nodes that die, freeze and come back, CPUs that
/// hang or are reset. Every promise of the ring is checked all the time; afterwards all is mended, and the ring
/// has to be whole again and fall silent.
class RandomFaults {
 public:
  /// Which rings fold back around a break: a third of them, or all.
  enum class FoldBack { some, all };
  /// What the simulated world is like: all nodes and lines alike, with ids 0, 1, 2 ...; or wide: sparse and unordered
  /// ids, rarely up to 254 nodes, lines that differ in rate and delay, take time to connect, or take nothing for a
  /// while, nodes that stand still and keep what comes, and traffic once more when all is mended.
  enum class World { usual, wide };
  explicit RandomFaults(std::uint64_t seed, FoldBack fold_back = FoldBack::some, World world = World::usual);

  /// Runs it all, or until a promise is broken.
  /// @param asked_to_stop asked many times, whatever the ring is at
  /// @return false where it said so: then the run has not ended, and nothing was judged at its end
  bool run(std::function<bool()> asked_to_stop = [] { return false; });
  /// The ring, for further observers before it runs.
  sim::VirtualRing& ring() { return *ring_; }
  const std::optional<sim::Violation>& violation() const { return violation_; }

  /// What the seed has chosen, in words.
  std::string describe() const;
  /// From now on all that is done to the ring is kept. @pre the usual world
  void keep_history() { keeps_history_ = true; }
  const std::vector<RecordedStep>& history() const { return history_; }
  /// Until then something was done to it; afterwards all was mended.
  core::Time acted_until() const { return acted_until_; }
  bool paced() const { return paced_; }
  bool folds_back() const { return fold_back_; }
  /// Results of DATPs and INTPs, by core::Outcome.
  const std::array<unsigned, wire::kOutcomes>& ended() const { return ended_; }
  unsigned nodes() const { return nodes_; }
  std::uint64_t hops() const;

 private:
  unsigned random(unsigned below) { return static_cast<unsigned>(random_() % below); }
  /// True once in so many times.
  bool once_in(unsigned times) { return times != 0 && random(times) == 0; }
  wire::NodeId random_node() { return order_[random(nodes_)]; }
  wire::NodeId random_destination() { return once_in(5) ? wire::kBroadcast : random_node(); }

  unsigned wide(unsigned below) { return static_cast<unsigned>(wide_() % below); }
  void choose_mix(FoldBack fold_back);
  void choose_world();
  void grow();
  void differ(core::Settings& settings) const;
  void stand_still(wire::NodeId node);
  void hold_output(wire::NodeId node);
  void send_when_mended();
  void make_ring();
  void tap_all(core::Line line);
  void pass(wire::NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  void act();
  void send();
  void interrupt();
  void fault();
  void line_fault(wire::NodeId node);
  /// Nanoseconds: that part of the time-out of a try.
  unsigned longest_hold(wire::NodeId node, int share) const;
  void cut(wire::NodeId node);
  void heal(wire::NodeId node);
  void kill_or_start(wire::NodeId node);
  void freeze_or_thaw(wire::NodeId node);
  void calm_down();
  void check_silence();
  void note_violation();
  bool must_stop() { return stopped_ = stopped_ || asked_to_stop_(); }
  bool goes_on() { return !violation_ && !must_stop(); }
  void run_until_calm();

  /// A node of a CPU that can ask for sends.
  bool can_ask(wire::NodeId node) const { return ring_->alive(node) && !ring_->paused(node); }
  template <class What>
  void record(const What& what) {
    if (keeps_history_) history_.push_back({ring_->now(), what});
  }
  void note(fault::Name name, wire::NodeId node);
  void note(scenario::SoakAction::Kind kind, wire::NodeId node, bool second_line = false);
  void note_slice(scenario::SoakAction::Kind kind, wire::NodeId id, core::Line line, std::size_t byte = 0,
                  std::uint8_t bits = 1);
  void count_slice(wire::NodeId id, core::Line line);

  std::uint64_t seed_;
  std::mt19937_64 random_;
  bool is_wide_;
  std::mt19937_64 wide_;  ///< for wide worlds alone: seeds of usual ones give the same runs as ever
  unsigned nodes_ = 16;
  core::RingOrder order_;
  std::vector<core::Duration> delays_;  ///< of the lines into the nodes, by place; of a wide world
  std::vector<unsigned> slownesses_;    ///< of the lines out of them: so many times the byte time
  bool paced_ = false;
  bool fold_back_ = false;
  unsigned drop_ = 0, damage_ = 0, trouble_ = 0;  ///< once in so many slices, slices, steps; 0: never
  bool doubles_ = false;                          ///< lines duplicate packets, and hold back only briefly
  bool quiet_ = false;
  std::function<bool()> asked_to_stop_;
  bool stopped_ = false;
  std::uint64_t slices_when_quiet_ = 0;
  std::vector<bool> killed_;  ///< if not alive: killed (true) or frozen
  std::array<unsigned, wire::kOutcomes> ended_{};
  std::unique_ptr<sim::VirtualRing> ring_;
  std::unique_ptr<sim::VirtualLineFaults> lines_;
  std::unique_ptr<sim::Invariants> invariants_;
  std::optional<sim::Violation> violation_;

  /// The slices that have left onto a line at one instant.
  struct AtInstant {
    core::Time at{core::Duration{-1}};
    unsigned slices = 0;
  };
  bool keeps_history_ = false;
  std::vector<RecordedStep> history_;
  core::Time acted_until_{};
  std::array<std::vector<AtInstant>, 2> leaving_;  ///< by line and node
};

}  // namespace limb_ring::study
