#include "sim/scenario_run.h"

#include <algorithm>
#include <functional>

#include "config/quantity.h"
#include "sim/soak_stage.h"
#include "sim/stage.h"

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
  void log(Note what) { result_.log.push_back({now(), std::move(what)}); }
  void log(std::string words) { log(Note{std::move(words), {}, {}}); }
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
    if (!scenario_.sometimes.empty()) judge_goals(stage_.goals_met());
  }

  void judge_goals(const std::vector<std::uint64_t>& met) {
    for (const std::size_t place : scenario_.sometimes) {
      const sim::Goal& goal = sim::goals()[place];
      const std::string words = std::string("sometimes ") + goal.name + ": " + goal.sentence;
      if (met[place] == 0) fail(words, "it did not happen");
      if (met[place] != 0) log(words + ": " + std::to_string(met[place]) + (met[place] == 1 ? " time" : " times"));
    }
  }

  void count_sends() {
    for (const Step& step : scenario_.steps) {
      const auto* send = std::get_if<Send>(&step.action);
      const auto same = [send](const SendResults& other) { return other.name == send->name; };
      if (send && std::none_of(result_.sends.begin(), result_.sends.end(), same))
        result_.sends.push_back({send->name, stage_.tally(send->name)});
    }
  }

  /// What has to hold at every poll. @return true if it does
  bool watch() {
    if (result_.unmet) return false;
    if (++polls_ % kPollsBetween == 0) goes_on_();
    for (Note& note : stage_.take_notes()) log(std::move(note));
    if (const auto broken = stage_.broken()) return fail(broken->expected, broken->seen);
    for (const Condition& condition : scenario_.always)
      if (!holds_so_far(condition, stage_)) return fail("always " + condition.words, seen(condition, stage_));
    for (const Condition& condition : scenario_.never)
      if (holds(condition, stage_)) return fail("never " + condition.words, seen(condition, stage_));
    return true;
  }

  /// @return false if something did not hold on the way
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

namespace {

std::vector<NodeId> those(const Who& who, const StageView& view) {
  std::vector<NodeId> nodes;
  for (unsigned i = 0; i < view.size(); ++i) {
    const auto id = static_cast<NodeId>(i);
    if (who.kind == Who::Kind::one && id != who.node) continue;
    if (who.kind == Who::Kind::living && !view.alive(id)) continue;
    nodes.push_back(id);
  }
  return nodes;
}

std::string none_if_empty(const std::string& text) { return text.empty() ? "nothing of it" : text; }

/// Joins what `say` returns for each node; an empty text is left out.
std::string list(const std::vector<NodeId>& nodes, const std::function<std::string(NodeId)>& say) {
  std::string text;
  for (const NodeId id : nodes) {
    const std::string words = say(id);
    if (!words.empty()) text += (text.empty() ? "" : "; ") + words;
  }
  return none_if_empty(text);
}

// ---- network controllers --------------------------------------------------------------------

bool holds_at(const NodeIs& node, NodeId id, const StageView& view) {
  const bool alive = view.alive(id);
  if (node.down || !alive) return node.down && !alive;
  return (!node.state || view.state(id) == *node.state) && (!node.ring_size || view.ring_size(id) == *node.ring_size);
}

std::string state_words(NodeId id, const StageView& view) {
  if (!view.alive(id)) return view.name(id) + " is down";
  return view.name(id) + " is " + to_string(view.state(id)) + ", in a ring of " + std::to_string(view.ring_size(id));
}

/// Of nobody it does not hold: if no node lives, nothing has been seen.
bool holds_now(const NodeIs& node, const StageView& view) {
  const std::vector<NodeId> nodes = those(node.who, view);
  for (const NodeId id : nodes)
    if (!holds_at(node, id, view)) return false;
  return !nodes.empty();
}

std::string describe(const NodeIs& node, const StageView& view) {
  const bool one = node.who.kind == Who::Kind::one;
  const std::vector<NodeId> nodes = those(node.who, view);
  if (nodes.empty()) return "no node is alive";
  return list(nodes,
              [&](NodeId id) { return one || !holds_at(node, id, view) ? state_words(id, view) : std::string(); });
}

// ---- what beacons have told -----------------------------------------------------------------

std::vector<NodeId> living_others(NodeId not_this, const StageView& view) {
  std::vector<NodeId> nodes;
  for (const NodeId id : those({Who::Kind::living, {}}, view))
    if (id != not_this) nodes.push_back(id);
  return nodes;
}

bool holds_now(const CpuIs& cpu, const StageView& view) {
  const std::vector<NodeId> others = living_others(cpu.node, view);
  for (const NodeId id : others) {
    const auto beacon = view.heard(id, cpu.node);
    if (!beacon) return false;
    if (cpu.state && beacon->cpu_state != *cpu.state) return false;
    if (cpu.boots && beacon->cpu_boots != *cpu.boots) return false;
  }
  return !others.empty();
}

std::string describe(const CpuIs& cpu, const StageView& view) {
  const std::vector<NodeId> told = living_others(cpu.node, view);
  if (told.empty()) return "no other node is alive";
  const auto beacon = view.heard(told[0], cpu.node);
  if (!beacon) return view.name(told[0]) + " has not heard of it";
  return view.name(told[0]) + " has heard that it is " + to_string(beacon->cpu_state) + " in boot " +
         std::to_string(beacon->cpu_boots);
}

bool knows(NodeId id, const Located& line, const StageView& view) {
  const auto beacon = view.heard(id, line.behind);
  return beacon && beacon->break_known && beacon->break_before == line.before && beacon->break_behind == line.behind;
}

bool holds_now(const Located& line, const StageView& view) {
  const std::vector<NodeId> others = living_others(line.behind, view);
  for (const NodeId id : others)
    if (!knows(id, line, view)) return false;
  return !others.empty();
}

std::string describe(const Located& line, const StageView& view) {
  return list(living_others(line.behind, view),
              [&](NodeId id) { return knows(id, line, view) ? std::string() : view.name(id) + " does not know"; });
}

// ---- counts ---------------------------------------------------------------------------------

std::uint64_t count_of(const Counted& counted, const StageView& view) {
  std::uint64_t sum = 0;
  for (const NodeId id : those(counted.of, view)) sum += view.counter(id, counted.counter);
  return sum;
}

std::uint64_t count_of(const Results& results, const StageView& view) {
  return view.tally(results.send).results[static_cast<std::size_t>(results.are)];
}

std::uint64_t count_of(const Taken& taken, const StageView& view) { return view.tally(taken.send).taken; }

template <class T>
bool holds_now(const T& counted, const StageView& view) {
  return counted.range.holds(count_of(counted, view));
}

std::string describe(const Counted& counted, const StageView& view) { return std::to_string(count_of(counted, view)); }

std::string describe(const Taken& taken, const StageView& view) { return std::to_string(count_of(taken, view)); }

std::string describe(const Results& results, const StageView& view) {
  const Tally& tally = view.tally(results.send);
  std::string text;
  for (std::size_t i = 0; i < tally.results.size(); ++i)
    if (tally.results[i] != 0)
      text += (text.empty() ? "" : ", ") + std::to_string(tally.results[i]) + ' ' +
              to_string(static_cast<core::Outcome>(i));
  return none_if_empty(text);
}

bool none_confirmed(const Latency& latency, const StageView& view) {
  return view.tally(latency.send).results[static_cast<std::size_t>(core::Outcome::delivered)] == 0;
}

/// Of none it does not hold: nothing has been seen.
bool holds_now(const Latency& latency, const StageView& view) {
  return !none_confirmed(latency, view) &&
         view.tally(latency.send).worst <= core::Duration(view.allowed(latency.at_most));
}

std::string describe(const Latency& latency, const StageView& view) {
  if (none_confirmed(latency, view)) return "none was confirmed";
  const core::Duration worst = view.tally(latency.send).worst;
  return config::format_time(core::whole_nanoseconds(worst));
}

}  // namespace

bool holds(const Condition& condition, const StageView& view) {
  return std::visit([&](const auto& what) { return holds_now(what, view); }, condition.what);
}

bool holds_so_far(const Condition& condition, const StageView& view) {
  const auto* latency = std::get_if<Latency>(&condition.what);
  return (latency != nullptr && none_confirmed(*latency, view)) || holds(condition, view);
}

std::string seen(const Condition& condition, const StageView& view) {
  return std::visit([&](const auto& what) { return describe(what, view); }, condition.what);
}

}  // namespace limb_ring::scenario
