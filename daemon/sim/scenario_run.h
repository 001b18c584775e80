#pragma once

#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "sim/planned_ring.h"
#include "sim/stage.h"

namespace limb_ring::scenario {

/// One thing that was done or seen.
struct LogLine {
  nanoseconds at{0};  ///< from the start, rounded down
  Note what;
};

/// An expectation that was not met.
struct Unmet {
  nanoseconds at{0};
  std::string expected, seen;
};

/// How an Unmet names a step's `when`.
std::string expectation(const Condition& condition, nanoseconds within);

/// What became of the sends of one name.
struct SendResults {
  std::string name;
  Tally tally;
};

/// Of all that happened on a virtual ring with real programs.
struct RunTrace {
  std::string hash;
  std::string not_repeatable;  ///< why another run may have another hash; empty: nothing is known that would do that
};

struct ScenarioRun {
  std::string name, path;
  std::uint64_t seed = 0;
  std::uint32_t order = 0;  ///< in which programs act in one instant (VirtualClockConfig); 0: none was drawn
  bool live = false;
  std::optional<RunTrace> trace;  ///< with real programs under a virtual clock
  std::vector<LogLine> log;
  std::optional<Unmet> unmet;  ///< the first; nothing after it was done
  nanoseconds lasted{0};
  std::vector<SendResults> sends;  ///< in the scenario's order, at its end
};

/// Runs a scenario under a virtual clock; every promise of the ring is an expectation too. The same scenario
/// and seed give the same run.
/// @param capture where its packets go as pcapng, or null; taken where `at` says
/// @param goes_on called now and then; throws to end it
ScenarioRun run_scenario(
    const Scenario& scenario, std::uint64_t seed, std::ostream* capture = nullptr,
    sim::CaptureAt at = sim::CaptureAt::inputs, const std::function<void()>& goes_on = [] {});

/// Runs it once: as above, or with real programs. @param capture as above
using Runner = std::function<ScenarioRun(const Scenario& scenario, std::uint64_t seed, std::ostream* capture)>;

/// Plays it on a stage that has not begun. @param seed the stage's, for the report
ScenarioRun run_scenario(const Scenario& scenario, std::uint64_t seed, Stage& stage);

/// Whether a condition holds at this moment.
bool holds(const Condition& condition, const StageView& view);

/// The same for what has to hold at every moment: a latency does also while nothing has been confirmed.
bool holds_so_far(const Condition& condition, const StageView& view);

/// What the ring shows at the moment, in words: "left_knee is joining, in a ring of 15".
std::string seen(const Condition& condition, const StageView& view);

}  // namespace limb_ring::scenario
