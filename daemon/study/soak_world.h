#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "core/settings.h"
#include "sim/scenario.h"
#include "sim/virtual_ring.h"

namespace limb_ring::study {

/// Random numbers of one seed. Whoever draws keeps the order of draws: otherwise seeds would no longer give the same
/// runs as before.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : random_(seed) {}

  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }
  /// True once in so many times; 0: never.
  bool once_in(unsigned times) { return times != 0 && below(times) == 0; }

 private:
  std::mt19937_64 random_;
};

/// Which rings fold back around a break: a third of them, or all.
enum class FoldingRings { some, all };
/// What the simulated world is like: all nodes and lines alike, with ids 0, 1, 2 ...; or wide: sparse and unordered
/// ids, rarely up to 254 nodes, lines that differ in rate and delay, take time to connect, or take nothing for a
/// while, nodes that stand still and keep what comes, and traffic once more when all is mended; or in parts: a wide one
/// of up to 16 nodes, on several hosts, of which half fold back. There the two ends of a line that is gone notice that
/// independently, nothing to kNoticedWithin later; hosts lose each other and regroup; and strikes come in bursts, near
/// each other and within a lap; or storms: in parts, of 3 to 6 nodes that fold back, where again and again all is
/// mended and such a burst comes, so that each meets a ring that is whole, or not yet; in half of them fold words are
/// lost.
enum class WorldKind { usual, wide, parts, storms };
constexpr std::array<const char*, 4> kWorldNames{"usual", "wide", "parts", "storms"};  ///< by WorldKind
/// The `silence` of a link (protocol.md section 7.4) beside the short times of these rings.
constexpr core::Duration kNoticedWithin = std::chrono::microseconds(300);

/// What a seed has chosen before anything happens: a ring, its lines, and how often something goes wrong on it.
struct SoakWorld {
  /// @param draws the seed's
  /// @param wide for wide worlds alone: seeds of usual ones give the same runs as ever
  SoakWorld(FoldingRings folding, WorldKind kind, Draws& draws, Draws& wide);

  /// Short times for all nodes; and what its lines are to this one, with what follows from them for the whole ring.
  void adjust(core::Settings& settings) const;
  /// In words.
  std::string describe() const;

  bool is_wide;
  bool in_parts;  ///< its hosts lose each other
  bool storms;
  unsigned lost_words = 0;  ///< once in so many fold words; 0: never
  unsigned nodes = 16;
  core::RingOrder order;
  std::vector<core::Duration> delays;  ///< of the lines into the nodes, by place; of a wide world
  std::vector<unsigned> slownesses;    ///< of the lines out of them: so many times the byte time
  bool takes_time_to_connect = false;
  bool paced = false;  ///< lines have a rate
  bool folds_back = false;
  unsigned drop = 0, damage = 0, trouble = 0;  ///< once in so many slices, slices, steps; 0: never
  bool doubles = false;                        ///< lines duplicate packets, and hold back only briefly

 private:
  void choose_mix(FoldingRings folding, Draws& draws);
  void choose_parts(FoldingRings folding, Draws& wide);
  void choose_nodes(Draws& wide);
  void grow(Draws& wide);
  void differ(core::Settings& settings) const;
};

/// What only the other worlds have, and no scenario.
struct WorldAction {
  enum class Kind : std::uint8_t {
    part,         ///< two hosts lose each other: the nodes from this one on are one of them
    regroup,      ///< they reach each other again
    stand_still,  ///< the node keeps what comes, and does nothing
    hold_output,  ///< its line takes nothing
    mend_all
  } kind = Kind::mend_all;
  wire::NodeId node{0};
  std::size_t nodes = 0;  ///< of the part
  core::Duration lasts{0};
};

/// One thing that was done to a ring: what, in the words of scenarios, and when. Nodes are ids.
struct RecordedStep {
  core::Time at{};
  std::variant<fault::Fault, scenario::Send, scenario::SoakAction, WorldAction> what;
};
/// The slice that it is done to, as it leaves; null: it is done to something else.
const scenario::SoakAction* slice_hit(const RecordedStep& step);

/// All that was done to a ring, from keep() on, so that it can be done again.
class SoakHistory {
 public:
  explicit SoakHistory(const sim::VirtualRing& ring) : ring_(ring) {}

  void keep() { kept_ = true; }
  const std::vector<RecordedStep>& steps() const { return steps_; }

  template <class What>
  void add(const What& what) {
    if (kept_) steps_.push_back({ring_.now(), what});
  }
  void add(fault::Name name, wire::NodeId node);
  void add(scenario::SoakAction::Kind kind, wire::NodeId node, bool second_line = false);
  /// How long an end of a line takes to notice something, or to connect: drawn.
  void add_wait(core::Duration wait) {
    if (kept_) waits_[ring_.now()].push_back(wait);
  }
  const std::map<core::Time, std::vector<core::Duration>>& waits() const { return waits_; }

  /// A slice has left that node; to be called for each, since an action on one is known by its number in its instant.
  void count_slice(wire::NodeId node, core::Line line);
  /// What was done to the slice counted last. @param byte and `bits`: where it was damaged
  void add_slice(scenario::SoakAction::Kind kind, wire::NodeId node, core::Line line, std::size_t byte = 0,
                 std::uint8_t bits = 1);

 private:
  /// The slices that have left onto a line at one instant.
  struct AtInstant {
    core::Time at{core::Duration{-1}};
    unsigned slices = 0;
  };

  const sim::VirtualRing& ring_;
  bool kept_ = false;
  std::vector<RecordedStep> steps_;
  std::map<core::Time, std::vector<core::Duration>> waits_;  ///< in the order in which they were drawn in that instant
  std::array<std::vector<AtInstant>, 2> leaving_;            ///< by line and node
};

}  // namespace limb_ring::study
