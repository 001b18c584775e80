#include "sim/scenario_run.h"

#include <algorithm>

#include "config/quantity.h"
#include "sim/conditions.h"
#include "sim/soak_stage.h"
#include "sim/virtual_stage.h"

namespace limb_ring::scenario {

namespace {

using core::Duration;

/// Always in us, the unit of round trips.
std::string microseconds(nanoseconds time) {
  const std::string thousandths = std::to_string(1000 + time.count() % 1000);
  return std::to_string(time.count() / 1000) + '.' + thousandths.substr(1) + " us";
}

/// Nodes are places in ring order here.
capture::RingNames names_of(const config::RingConfig& ring) {
  capture::RingNames names{ring.ring, {}};
  for (const auto& node : ring.nodes) names.nodes.emplace(static_cast<NodeId>(names.nodes.size()), node.name);
  return names;
}

}  // namespace

std::string expectation(const Condition& condition, nanoseconds within) {
  return "when " + condition.words + " within " + config::format_time(within);
}

namespace {

class Run {
 public:
  Run(const Scenario& scenario, std::uint64_t seed, Stage& stage, const std::function<void()>& goes_on)
      : scenario_(scenario), stage_(stage), goes_on_(goes_on) {
    result_.name = scenario.name;
    result_.path = scenario.path;
    result_.seed = seed;
    result_.live = !stage.exact();
  }

  ScenarioRun run() {
    begin();
    for (const Step& step : scenario_.steps)
      if (result_.unmet || !do_step(step)) break;
    if (!result_.unmet) end();
    result_.lasted = now();
    count_sends();
    return std::move(result_);
  }

 private:
  nanoseconds now() const { return core::whole_nanoseconds(stage_.now()); }
  void log(const std::string& words) { result_.log.push_back({now(), words}); }
  bool fail(const std::string& expected, const std::string& seen) {
    if (!result_.unmet) result_.unmet = Unmet{now(), expected, seen};
    return false;
  }

  void begin() {
    if (const auto failure = stage_.begin()) {
      fail(failure->expected, failure->seen);
      return;
    }
    const std::size_t there = scenario_.ring.nodes.size() - scenario_.absent.size();
    log("start: " + std::to_string(there) + (scenario_.world == World::soak ? " nodes" : " nodes have joined"));
    go_to(Duration{0});
  }

  void end() {
    if (const auto failure = stage_.end()) fail(failure->expected, failure->seen);
  }

  void count_sends() {
    for (const Step& step : scenario_.steps) {
      const auto* send = std::get_if<Send>(&step.action);
      const auto same = [send](const SendResults& other) { return other.name == send->name; };
      if (send && std::none_of(result_.sends.begin(), result_.sends.end(), same))
        result_.sends.push_back({send->name, stage_.tally(send->name)});
    }
  }

  /// What has to hold at every poll. @return true where it does
  bool watch() {
    if (result_.unmet) return false;
    if (++polls_ % kPollsBetween == 0) goes_on_();
    for (const std::string& note : stage_.take_notes()) log(note);
    if (const auto broken = stage_.broken()) return fail(broken->expected, broken->seen);
    for (const Condition& condition : scenario_.always)
      if (!holds_so_far(condition, stage_)) return fail("always " + condition.words, seen(condition, stage_));
    for (const Condition& condition : scenario_.never)
      if (holds(condition, stage_)) return fail("never " + condition.words, seen(condition, stage_));
    return true;
  }

  /// @return false where something did not hold on the way
  bool go_to(Duration until) {
    if (stage_.exact() && until < stage_.now()) return fail("a step that is in time", "it was later already");
    stage_.run_until([this] { return !watch(); }, until, "waiting for the next step");
    return !result_.unmet;
  }

  bool wait_for(const Condition& condition, const Limit& limit) {
    const nanoseconds within = stage_.allowed(limit);
    const std::string expected = expectation(condition, within);
    const Duration from = stage_.now();
    bool reached = false;
    const auto done = [&] { return !watch() || (reached = holds(condition, stage_)); };
    stage_.run_until(done, from + Duration(within), expected);
    if (result_.unmet) return false;
    if (!reached) return fail(expected, seen(condition, stage_));
    log(expected + ": after " + microseconds(core::whole_nanoseconds(stage_.now() - from)));
    return true;
  }

  bool do_step(const Step& step) {
    if (step.at && !go_to(Duration(*step.at))) return false;
    if (step.after && !go_to(stage_.now() + Duration(*step.after))) return false;
    if (step.when && !wait_for(*step.when, step.within)) return false;
    if (!step.words.empty()) log("do " + step.words);
    if (const auto* fault = std::get_if<Fault>(&step.action))
      if (const auto problem = stage_.apply(*fault)) return fail(problem->expected, problem->seen);
    if (const auto* send = std::get_if<Send>(&step.action)) stage_.send(*send);
    if (const auto* action = std::get_if<SoakAction>(&step.action)) stage_.apply(*action);
    return true;
  }

  static constexpr unsigned kPollsBetween = 1000;  ///< under a virtual clock a millisecond or so

  const Scenario& scenario_;
  Stage& stage_;
  const std::function<void()>& goes_on_;
  unsigned polls_ = 0;
  ScenarioRun result_;
};

}  // namespace

ScenarioRun run_scenario(const Scenario& scenario, std::uint64_t seed, Stage& stage) {
  return Run(scenario, seed, stage, [] {}).run();
}

namespace {

template <class OfWorld>
ScenarioRun run_on(const Scenario& scenario, std::uint64_t seed, std::ostream* capture, sim::CaptureAt at,
                   const std::function<void()>& goes_on) {
  OfWorld stage(scenario, seed);
  std::optional<sim::RingCapture> captured;
  if (capture != nullptr) captured.emplace(stage.ring(), *capture, names_of(scenario.ring), at);
  return Run(scenario, seed, stage, goes_on).run();
}

}  // namespace

ScenarioRun run_scenario(const Scenario& scenario, std::uint64_t seed, std::ostream* capture, sim::CaptureAt at,
                         const std::function<void()>& goes_on) {
  if (scenario.world == World::soak) return run_on<SoakStage>(scenario, seed, capture, at, goes_on);
  return run_on<VirtualStage>(scenario, seed, capture, at, goes_on);
}

}  // namespace limb_ring::scenario
