#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "sim/recorded_events.h"

namespace limb_ring::sim {

/// How a recorded story is told once more.
struct Retelling {
  std::vector<bool> kept;             ///< by event: it happens
  std::vector<core::Duration> later;  ///< by event: so much later, perhaps below 0; empty: none
  std::size_t exact_until = 0;        ///< the calls before that one are done as they were recorded
  core::Time until{};                 ///< nothing of what is kept comes later
};

/// Goes on from what was recorded: the very same cores, first exactly as they did it, and from one instant on as a ring
/// of their own. There what came from outside comes at its recorded time, slices take as long from node to node as
/// lines have taken typically, and CPUs take packets at once. All is judged alike. (ours)
/// @param breaks called with each broken promise; returns true to stop
/// @return true if it did
bool retell(const RecordedWindow& window, const RecordedEvents& events, const Retelling& retelling,
            const RecordedJudging& judging, const std::function<bool(const promises::Breach&)>& breaks);

}  // namespace limb_ring::sim
