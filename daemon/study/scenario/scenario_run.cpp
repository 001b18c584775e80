#include "study/scenario/scenario_run.h"

#include "config/quantity.h"
#include "study/ring_capture.h"
#include "study/scenario/look.h"

namespace limb_ring::study::scenario {

namespace {

using core::Duration;
using core::Time;

/// In us: the ring's own measure, whatever the length.
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

class Run {
 public:
  Run(const Scenario& scenario, std::uint64_t seed, std::ostream* capture)
      : scenario_(scenario), robot_(scenario, seed) {
    if (capture != nullptr) capture_.emplace(robot_.ring(), *capture, names_of(scenario.ring));
    result_.name = scenario.name;
    result_.path = scenario.path;
    result_.seed = seed;
  }

  ScenarioRun run() {
    begin();
    for (const Step& step : scenario_.steps)
      if (result_.unmet || !do_step(step)) break;
    result_.lasted = now();
    return std::move(result_);
  }

 private:
  nanoseconds now() const { return std::chrono::duration_cast<nanoseconds>(robot_.ring().now() - start_); }
  void log(const std::string& words) { result_.log.push_back({now(), words}); }
  bool fail(const std::string& expected, const std::string& seen) {
    if (!result_.unmet) result_.unmet = Unmet{now(), expected, seen};
    return false;
  }

  void begin() {
    const bool joined = robot_.ring().join();
    start_ = robot_.ring().now();
    if (!joined) return void(fail("every node joins", "not within 10 s"));
    const std::size_t there = scenario_.ring.nodes.size() - scenario_.absent.size();
    log("start: " + std::to_string(there) + " nodes have joined");
    watch();
  }

  /// What has to hold at every moment. @return true where it does
  bool watch() {
    if (result_.unmet) return false;
    if (const auto& broken = robot_.ring().violation())
      return fail(std::string("the ring's promise: ") + sim::to_string(broken->promise), broken->what);
    for (const Condition& condition : scenario_.always)
      if (!holds(condition, robot_)) return fail("always " + condition.words, seen(condition, robot_));
    for (const Condition& condition : scenario_.never)
      if (holds(condition, robot_)) return fail("never " + condition.words, seen(condition, robot_));
    return true;
  }

  /// @return false where something did not hold on the way
  bool go_to(Time until) {
    if (until < robot_.ring().now()) return fail("a step that is in time", "it was later already");
    robot_.ring().run_until([this] { return !watch(); }, until - robot_.ring().now());
    if (!result_.unmet) robot_.ring().run_until(until);
    return watch();
  }

  bool wait_for(const Condition& condition, nanoseconds within) {
    const Time from = robot_.ring().now(), until = from + Duration(within);
    bool reached = false;
    const auto done = [&] { return !watch() || (reached = holds(condition, robot_)); };
    if (!robot_.ring().run_until(done, Duration(within)) && !go_to(until)) return false;
    if (result_.unmet) return false;
    const std::string expected = "when " + condition.words + " within " + config::format_time(within);
    if (!reached && !holds(condition, robot_)) return fail(expected, seen(condition, robot_));
    const auto took = std::chrono::duration_cast<nanoseconds>(robot_.ring().now() - from);
    log(expected + ": after " + microseconds(took));
    return true;
  }

  bool do_step(const Step& step) {
    if (step.at && !go_to(start_ + Duration(*step.at))) return false;
    if (step.after && !go_to(robot_.ring().now() + Duration(*step.after))) return false;
    if (step.when && !wait_for(*step.when, step.within)) return false;
    if (!step.words.empty()) log("do " + step.words);
    if (const auto* fault = std::get_if<Fault>(&step.deed)) robot_.apply(*fault);
    if (const auto* send = std::get_if<Send>(&step.deed)) robot_.send(*send);
    return true;
  }

  const Scenario& scenario_;
  Robot robot_;
  std::optional<RingCapture> capture_;
  Time start_{};
  ScenarioRun result_;
};

}  // namespace

ScenarioRun run_scenario(const Scenario& scenario, std::uint64_t seed, std::ostream* capture) {
  return Run(scenario, seed, capture).run();
}

}  // namespace limb_ring::study::scenario
