#pragma once

#include <string>
#include <vector>

#include "core/settings.h"
#include "study/soak/draws.h"

namespace limb_ring::study {

/// Which rings fold back around a break: a third of them, or all.
enum class FoldingRings { some, all };
/// What the simulated world is like: all nodes and lines alike, with ids 0, 1, 2 ...; or wide: sparse and unordered
/// ids, rarely up to 254 nodes, lines that differ in rate and delay, take time to connect, or take nothing for a
/// while, nodes that stand still and keep what comes, and traffic once more when all is mended; or in parts: a wide one
/// of up to 16 nodes, on several hosts, of which half fold back. There the two ends of a line that is gone notice that
/// independently, nothing to kNoticedWithin later; hosts lose each other and regroup; and strikes come in bursts, near
/// each other and within a lap.
enum class WorldKind { usual, wide, parts };
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

}  // namespace limb_ring::study
