#include "study/shrunk_soak.h"

#include <algorithm>
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

/// A ring of the soak with nodes 0, 1, 2 ..., in the words of a scenario.
class Words {
 public:
  explicit Words(unsigned nodes) : nodes_(nodes) {
    for (unsigned id = 0; id < nodes; ++id)
      ring_.push_back({name_of(static_cast<NodeId>(id)), std::to_string(id), static_cast<NodeId>(id)});
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

 private:
  NodeId behind(const SoakAction& action) const {
    return static_cast<NodeId>((action.node + (action.second_line ? nodes_ - 1 : 1)) % nodes_);
  }

  unsigned nodes_;
  fault::RingNodes ring_;
  std::size_t sends_ = 0;
};

bool is_of_slice(const RecordedStep& step) {
  const auto* action = std::get_if<SoakAction>(&step.what);
  return action && (action->kind == Kind::lose_slice || action->kind == Kind::damage_slice);
}

/// When the step is due. One that hits a slice has to be in place before the slice leaves.
std::chrono::nanoseconds due(const RecordedStep& step) {
  using std::chrono::nanoseconds;
  const core::Duration since = step.at.time_since_epoch();
  if (!is_of_slice(step)) return core::whole_nanoseconds(since);
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
    Words words(nodes);
    for (const RecordedStep& step : steps)
      text += "  - {at: " + config::format_time(due(step)) +
              ", do: " + std::visit([&](const auto& what) { return words.of(what); }, step.what) + "}\n";
    const auto end = core::whole_nanoseconds(until.time_since_epoch());
    return text + "  - {at: " + config::format_time(end) + "}\n";
  }
};

History history_of(const RandomFaults& run, std::uint64_t seed) {
  History history{run.nodes(), run.paced(), run.folds_back(), seed, run.acted_until(), run.history()};
  const auto earlier = [](const RecordedStep& a, const RecordedStep& b) { return due(a) < due(b); };
  std::stable_sort(history.steps.begin(), history.steps.end(), earlier);
  return history;
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

class SeedStory final : public scenario::Story {
 public:
  SeedStory(std::unique_ptr<scenario::Story> told, const sim::Violation& violation, std::vector<RecordedStep> steps,
            std::uint64_t seed, FoldingRings folding)
      : told_(std::move(told)),
        wanted_(unmet_of(violation)),
        steps_(std::move(steps)),
        seed_(seed),
        folding_(folding) {}

  std::size_t events() const override { return told_->events(); }
  std::chrono::nanoseconds at(std::size_t event) const override { return told_->at(event); }
  std::string words(std::size_t event) const override { return told_->words(event); }
  bool fails(const std::vector<std::size_t>& events) override { return told_->fails(events); }
  bool fails_swapped(const std::vector<std::size_t>& events, std::size_t one, std::size_t other) override {
    return told_->fails_swapped(events, one, other);
  }
  bool fails_after(std::size_t events, unsigned future) override {
    if (future <= 1) return told_->fails_after(events, future);
    RandomFaults other(seed_, folding_);
    other.draw_anew(end_of(events), future);
    other.run();
    return other.violation() && alike(unmet_of(*other.violation()), wanted_);
  }

 private:
  core::Time end_of(std::size_t events) const {
    core::Time end{};
    for (std::size_t i = 0; i < events; ++i) end = std::max(end, steps_[i].at + core::Duration{1});
    return end;
  }

  const std::unique_ptr<scenario::Story> told_;
  const Unmet wanted_;
  const std::vector<RecordedStep> steps_;
  const std::uint64_t seed_;
  const FoldingRings folding_;
};

}  // namespace

bool is_small(const scenario::ScenarioSize& size) { return size.faults <= 3 && size.sends <= 10; }

std::string scenario_of(const RandomFaults& run, std::uint64_t seed) { return history_of(run, seed).text(); }

std::string scenario_of(const RandomFaults& run, std::uint64_t seed, const std::vector<std::size_t>& steps) {
  History history = history_of(run, seed);
  history.keep(steps);
  return history.text();
}

std::unique_ptr<scenario::Story> story_of(const RandomFaults& run, std::uint64_t seed, FoldingRings folding) {
  const History history = history_of(run, seed);
  auto told = scenario::story_of(scenario::parse_scenario(history.text(), "soak"), seed);
  if (!told || !run.violation()) return nullptr;
  return std::make_unique<SeedStory>(std::move(told), *run.violation(), history.steps, seed, folding);
}

std::optional<scenario::Shrunk> shrunk_soak(const RandomFaults& run, std::uint64_t seed,
                                            const std::function<void(std::size_t runs)>& tell) {
  History history = history_of(run, seed);
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
