#include "study/shrunk_soak.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "config/fault_parse.h"
#include "config/quantity.h"
#include "sim/load_scenario.h"

namespace limb_ring::study {

using core::RingOrder;
using scenario::Scenario;
using scenario::SoakAction;
using scenario::Unmet;
using wire::NodeId;
using Kind = SoakAction::Kind;

namespace {

/// Number of different names. A named send is identified by one byte of its data, so names repeat after this many.
constexpr std::size_t kNames = 200;

std::string name_of(NodeId node) { return "node" + std::to_string(node); }

/// What is done to a ring of the soak, in the words of a scenario; what no scenario has, in others.
class Words {
 public:
  explicit Words(const RingOrder& order) : order_(order) {
    for (const NodeId id : order) ring_.push_back({name_of(id), std::to_string(id), id});
  }

  std::string of(const scenario::Send& send) {
    std::string text = "{send: {name: s" + std::to_string(sends_++ % kNames) + ", from: " + name_of(send.from[0]) +
                       ", to: " + (send.to == wire::kBroadcast ? "all" : name_of(send.to));
    if (send.interrupt) return text + ", interrupt: " + std::to_string(*send.interrupt) + "}}";
    return text + ", size: " + std::to_string(send.size) + ", priority: " + std::to_string(send.priority) + "}}";
  }
  std::string of(const fault::Fault& fault) const {
    const std::string words = fault::to_words(fault, ring_);
    const std::size_t space = words.find(' ');
    return "{" + words.substr(0, space) + ":" + words.substr(space) + "}";
  }
  std::string of(const SoakAction& action) const {
    const std::string line = name_of(action.node) + " -> " + name_of(behind(action));
    const std::string nth = action.nth == 1 ? "" : ", nth: " + std::to_string(action.nth);
    switch (action.kind) {
      case Kind::cut_wire:
        return "{wire: {cut: " + line + "}}";
      case Kind::mend_wire:
        return "{wire: {mend: " + line + "}}";
      case Kind::cut_cable:
        return "{cable: {cut: " + line + "}}";
      case Kind::mend_cable:
        return "{cable: {mend: " + line + "}}";
      case Kind::lose_slice:
        return "{slice: {lost: " + line + nth + "}}";
      case Kind::damage_slice:
        return "{slice: {damaged: " + line + nth + ", byte: " + std::to_string(action.byte) +
               ", bits: " + std::to_string(action.bits) + "}}";
      case Kind::cancel:
        break;
    }
    return "{cancel: " + name_of(action.node) + "}";
  }
  std::string of(const WorldAction& action) const {
    const std::string lasts = config::format_time(core::whole_nanoseconds(action.lasts));
    switch (action.kind) {
      case WorldAction::Kind::part:
        return "hosts lose each other: on one of them " + std::to_string(action.nodes) + " nodes from " +
               name_of(action.node) + " on";
      case WorldAction::Kind::regroup:
        return "hosts reach each other again";
      case WorldAction::Kind::stand_still:
        return name_of(action.node) + " stands still for " + lasts;
      case WorldAction::Kind::hold_output:
        return "the line out of " + name_of(action.node) + " takes nothing for " + lasts;
      case WorldAction::Kind::mend_all:
        break;
    }
    return "all is mended";
  }

 private:
  NodeId behind(const SoakAction& action) const {
    return core::node_after(order_, action.node, action.second_line ? order_.size() - 1 : 1);
  }

  const RingOrder order_;
  fault::RingNodes ring_;
  std::size_t sends_ = 0;
};

/// When the step is due. One that hits a slice has to be in place before the slice leaves.
std::chrono::nanoseconds due(const RecordedStep& step) {
  using std::chrono::nanoseconds;
  const core::Duration since = step.at.time_since_epoch();
  if (slice_hit(step) == nullptr) return core::whole_nanoseconds(since);
  const auto before = core::whole_nanoseconds(since - core::Duration{1});
  return std::max(nanoseconds{0}, before);
}

std::string head_of(unsigned nodes, bool paced, bool fold_back, std::uint64_t seed) {
  return "scenario: seed " + std::to_string(seed) + " of ring_sim soak\nworld: soak\nnodes: " + std::to_string(nodes) +
         (fold_back ? "\nredundancy: foldback" : "") + (paced ? "" : "\nrate: unlimited") +
         "\nseed: " + std::to_string(seed) + "\nsteps:";
}

/// A ring's history as text: what is above the steps, and a line for each.
struct History {
  unsigned nodes;
  bool paced, fold_back;
  std::uint64_t seed;
  core::Time until;  ///< then all is mended
  std::vector<RecordedStep> steps;

  /// Leaves out all other steps.
  void keep(const std::vector<std::size_t>& wanted) {
    std::vector<RecordedStep> kept;
    for (const std::size_t step : wanted) kept.push_back(steps[step]);
    steps = std::move(kept);
  }
  std::string text() const {
    std::string text = head_of(nodes, paced, fold_back, seed) + "\n";
    RingOrder order;
    for (unsigned id = 0; id < nodes; ++id) order.push_back(static_cast<NodeId>(id));
    Words words(order);
    for (const RecordedStep& step : steps)
      text += "  - {at: " + config::format_time(due(step)) +
              ", do: " + std::visit([&](const auto& what) { return words.of(what); }, step.what) + "}\n";
    const auto end = core::whole_nanoseconds(until.time_since_epoch());
    return text + "  - {at: " + config::format_time(end) + "}\n";
  }
};

/// As a scenario can do them.
std::vector<RecordedStep> steps_in_order(const RandomFaults& run) {
  std::vector<RecordedStep> steps = run.history();
  const auto earlier = [](const RecordedStep& a, const RecordedStep& b) { return due(a) < due(b); };
  std::stable_sort(steps.begin(), steps.end(), earlier);
  return steps;
}

History history_of(const RandomFaults& run) {
  return {run.nodes(), run.paced(), run.folds_back(), run.origin().seed, run.acted_until(), steps_in_order(run)};
}

// ---- fewer steps ----------------------------------------------------------------------------

/// Runs a scenario with some of its steps, until it has failed as wanted or long enough after it should have.
class StepTrial {
 public:
  StepTrial(const Scenario& scenario, const Unmet& wanted) : whole_(scenario), some_(scenario), wanted_(wanted) {
    wait_.at = *scenario.steps.back().at;
    some_.ends_mended = wanted.at > *wait_.at;
    if (!some_.ends_mended) wait_.at = std::min(*wait_.at, wanted.at + std::chrono::milliseconds(1));
  }
  bool operator()(const std::vector<std::size_t>& steps) {
    some_.steps.clear();
    for (const std::size_t step : steps)
      if (*whole_.steps[step].at <= *wait_.at) some_.steps.push_back(whole_.steps[step]);
    some_.steps.push_back(wait_);
    const auto run = run_scenario(some_, some_.seed);
    return run.unmet && alike(*run.unmet, wanted_);
  }

  /// The promise was broken only at the end, so that has to be played, too.
  bool plays_the_end() const { return some_.ends_mended; }

 private:
  const Scenario& whole_;
  Scenario some_;
  const Unmet& wanted_;
  scenario::Step wait_;
};

// ---- fewer nodes ----------------------------------------------------------------------------

template <class Visit>
void each_node(RecordedStep& step, Visit visit) {
  if (auto* fault = std::get_if<fault::Fault>(&step.what))
    for (NodeId& node : fault->nodes) visit(node);
  if (auto* action = std::get_if<SoakAction>(&step.what)) visit(action->node);
  if (auto* send = std::get_if<scenario::Send>(&step.what)) {
    visit(send->from[0]);
    if (send->to != wire::kBroadcast) visit(send->to);
  }
}

/// The same history in a ring of `nodes`: the nodes that it mentions come first, in their order.
/// @return nothing if it mentions more nodes than that
std::optional<History> among(const History& history, unsigned nodes) {
  History fewer = history;
  std::set<unsigned> used;
  for (RecordedStep& step : fewer.steps) each_node(step, [&](NodeId& node) { used.insert(node); });
  if (used.size() > nodes) return std::nullopt;
  const auto place = [&](NodeId node) { return std::distance(used.begin(), used.find(node)); };
  for (RecordedStep& step : fewer.steps)
    each_node(step, [&](NodeId& node) { node = static_cast<NodeId>(place(node)); });
  fewer.nodes = nodes;
  return fewer;
}

bool fails_as(const std::string& text, const Unmet& wanted, bool ends_mended) {
  Scenario scenario = scenario::parse_scenario(text, "soak");
  scenario.ends_mended = ends_mended;
  const auto run = run_scenario(scenario, scenario.seed);
  return run.unmet && alike(*run.unmet, wanted);
}

// ---- other futures --------------------------------------------------------------------------

Unmet unmet_of(const sim::Violation& violation) { return {{}, to_string(violation.promise), violation.what()}; }

/// Of any world: what the seed has done is done again to its ring.
class SeedStory final : public scenario::Story {
 public:
  /// @param run has kept its history, has broken a promise, and outlives this
  explicit SeedStory(const RandomFaults& run)
      : run_(run),
        wanted_(unmet_of(*run.violation())),
        steps_(steps_in_order(run)),
        breaks_at_end_(run.violation()->at > run.acted_until()) {
    Words words(run.order());
    for (const RecordedStep& step : steps_)
      words_.push_back(std::visit([&](const auto& what) { return words.of(what); }, step.what));
  }

  std::size_t events() const override { return steps_.size(); }
  std::chrono::nanoseconds at(std::size_t event) const override {
    return core::whole_nanoseconds(steps_[event].at.time_since_epoch());
  }
  std::string words(std::size_t event) const override { return words_[event]; }
  bool fails(const std::vector<std::size_t>& events) override { return fails_with(those(events)); }
  bool fails_swapped(const std::vector<std::size_t>& events, std::size_t one, std::size_t other) override {
    std::vector<RecordedStep> swapped = those(events);
    const auto step = [&](std::size_t event) -> RecordedStep& {
      return swapped[static_cast<std::size_t>(std::find(events.begin(), events.end(), event) - events.begin())];
    };
    std::swap(step(one).what, step(other).what);
    return fails_with(swapped);
  }
  bool fails_after(std::size_t events, unsigned future) override {
    const std::vector<RecordedStep> past(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(events));
    const core::Time from = begin_of_future(events), acted_until = run_.acted_until();
    RandomFaults other(run_.origin());
    if (future > 1) {
      other.draw_anew(from, future);
      other.run();
    } else {
      other.replay(run_, past, future == 1 ? std::min(from, acted_until) : acted_until, true);
    }
    return fails_alike(other);
  }

 private:
  std::vector<RecordedStep> those(const std::vector<std::size_t>& events) const {
    std::vector<RecordedStep> some;
    for (const std::size_t event : events) some.push_back(steps_[event]);
    return some;
  }
  /// Up to its end only if the promise was broken there, which takes most of the time.
  bool fails_with(const std::vector<RecordedStep>& steps) const {
    const core::Time soon = run_.violation()->at + std::chrono::milliseconds(1);
    RandomFaults again(run_.origin());
    again.replay(run_, steps, breaks_at_end_ ? run_.acted_until() : std::min(soon, run_.acted_until()), breaks_at_end_);
    return fails_alike(again);
  }
  bool fails_alike(const RandomFaults& run) const {
    return run.violation() && alike(unmet_of(*run.violation()), wanted_);
  }
  /// Just before the next event, so that what the last one has led to by then has happened; behind the very last one,
  /// at once.
  core::Time begin_of_future(std::size_t events) const {
    core::Time begin{};
    for (std::size_t i = 0; i < events; ++i) begin = std::max(begin, steps_[i].at + core::Duration{1});
    return events == steps_.size() ? begin : std::max(begin, steps_[events].at - core::Duration{1});
  }

  const RandomFaults& run_;
  const Unmet wanted_;
  const std::vector<RecordedStep> steps_;
  const bool breaks_at_end_;
  std::vector<std::string> words_;
};

}  // namespace

bool is_small(const scenario::ScenarioSize& size) { return size.faults <= 3 && size.sends <= 10; }

std::string scenario_of(const RandomFaults& run) { return history_of(run).text(); }

std::string scenario_of(const RandomFaults& run, const std::vector<std::size_t>& steps) {
  History history = history_of(run);
  history.keep(steps);
  return history.text();
}

std::unique_ptr<scenario::Story> story_of(const RandomFaults& run) {
  auto story = std::make_unique<SeedStory>(run);
  std::vector<std::size_t> all(story->events());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return story->fails(all) ? std::move(story) : nullptr;
}

std::optional<scenario::Shrunk> shrunk_soak(const RandomFaults& run,
                                            const std::function<void(std::size_t runs)>& tell) {
  History history = history_of(run);
  const std::uint64_t seed = run.origin().seed;
  const Scenario whole = scenario::parse_scenario(history.text(), "soak");
  const auto failed = run_scenario(whole, seed);
  if (!failed.unmet) return std::nullopt;
  std::size_t runs = 1;
  StepTrial trial(whole, *failed.unmet);
  scenario::ShrinkRequest request;
  const auto fails_alike = [&](const std::vector<std::size_t>& steps) {
    tell(++runs);
    return trial(steps);
  };
  const auto needed = scenario::needed_steps(history.steps.size(), request.most_runs, fails_alike);
  const bool stopped = runs > request.most_runs;
  history.keep(needed);
  for (unsigned nodes = history.fold_back ? 3 : 2; nodes < history.nodes; ++nodes) {
    const auto fewer = among(history, nodes);
    if (!fewer) continue;
    tell(++runs);
    if (fails_as(fewer->text(), *failed.unmet, trial.plays_the_end())) history = *fewer;
  }
  request.path = "seed " + std::to_string(seed) + " of ring_sim soak";
  request.text = history.text();
  request.tell = [&](std::size_t more) { tell(runs + more); };
  auto shrunk = scenario::shrink(request);
  if (!shrunk) return std::nullopt;
  shrunk->before = size_of(whole);
  shrunk->runs += runs;
  shrunk->stopped = shrunk->stopped || stopped;
  return shrunk;
}

}  // namespace limb_ring::study
