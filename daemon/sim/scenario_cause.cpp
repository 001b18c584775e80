#include "sim/scenario_cause.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "config/quantity.h"
#include "sim/scenario_shrink.h"

namespace limb_ring::scenario {
namespace {

/// A scenario whose steps can be left out. A step that waits for something goes on waiting.
class ScenarioStory final : public Story {
 public:
  ScenarioStory(const Scenario& scenario, std::uint64_t seed, const Unmet& unmet, Runner run)
      : whole_(scenario), seed_(seed), unmet_(unmet), run_(std::move(run)) {
    for (std::size_t i = 0; i < whole_.steps.size(); ++i)
      if (!std::holds_alternative<std::monostate>(whole_.steps[i].action)) events_.push_back(i);
    find_times();
    const nanoseconds last = whole_.steps.empty() ? nanoseconds{0} : whole_.steps.back().at.value_or(unmet.at);
    fails_before_end_ = whole_.world == World::soak && unmet.at <= last;
  }

  std::size_t events() const override { return events_.size(); }
  nanoseconds at(std::size_t event) const override { return times_[event]; }
  std::string words(std::size_t event) const override { return whole_.steps[events_[event]].words; }

  bool fails(const std::vector<std::size_t>& events) override {
    Scenario some = with(events);
    some.ends_mended = whole_.ends_mended && !fails_before_end_;
    return fails_alike(some);
  }
  bool fails_swapped(const std::vector<std::size_t>& events, std::size_t one, std::size_t other) override {
    Scenario swapped = whole_;
    std::swap(swapped.steps[events_[one]].action, swapped.steps[events_[other]].action);
    return fails_alike(keep(std::move(swapped), events));
  }
  bool fails_after(std::size_t events, unsigned future) override {
    std::mt19937_64 random(future);
    std::vector<std::size_t> kept;
    for (std::size_t event = 0; event < events_.size(); ++event)
      if (event < events || (future > 1 && random() % 2 == 0)) kept.push_back(event);
    Scenario other = with(kept);
    if (future == 1 && whole_.world == World::soak) end_at(begin_of_future(events), other);
    return fails_alike(other);
  }

 private:
  /// When each step is due, as far as the file says it; the times of waits are not known before they are over.
  void find_times() {
    nanoseconds now{0};
    std::size_t next = 0;
    for (std::size_t i = 0; i < whole_.steps.size(); ++i) {
      const Step& step = whole_.steps[i];
      now = step.at.value_or(now + step.after.value_or(nanoseconds{0}));
      if (next < events_.size() && events_[next] == i) {
        times_.push_back(now);
        ++next;
      }
    }
  }
  Scenario with(const std::vector<std::size_t>& events) const { return keep(whole_, events); }
  Scenario keep(Scenario scenario, const std::vector<std::size_t>& events) const {
    std::vector<bool> kept(scenario.steps.size(), false);
    for (const std::size_t event : events) kept[events_[event]] = true;
    std::vector<Step> steps;
    for (std::size_t i = 0; i < scenario.steps.size(); ++i) {
      Step& step = scenario.steps[i];
      const bool is_event = !std::holds_alternative<std::monostate>(step.action);
      if (is_event && !kept[i]) {
        step.action = std::monostate{};
        step.words.clear();
        if (step.at && !step.when && i + 1 < scenario.steps.size()) continue;  // another step says how long it lasts
      }
      steps.push_back(std::move(step));
    }
    scenario.steps = std::move(steps);
    return scenario;
  }
  /// Just before the next event, so that what the last one has led to by then has happened: a slice that is hit leaves
  /// within the next nanosecond. Behind the very last one, then. @pre the soak's world, in which all times are known
  nanoseconds begin_of_future(std::size_t events) const {
    const nanoseconds soonest = events == 0 ? nanoseconds{0} : times_[events - 1] + nanoseconds{2};
    return events == times_.size() ? soonest : std::max(soonest, times_[events] - nanoseconds{1});
  }
  /// All is mended from then on. @pre the soak's world
  void end_at(nanoseconds time, Scenario& scenario) const {
    auto& steps = scenario.steps;
    steps.erase(std::remove_if(steps.begin(), steps.end(), [&](const Step& step) { return step.at > time; }),
                steps.end());
    Step end;
    end.at = time;
    steps.push_back(end);
  }
  bool fails_alike(const Scenario& scenario) const {
    const ScenarioRun run = run_(scenario, seed_, nullptr);
    return run.unmet && alike(*run.unmet, unmet_);
  }

  const Scenario whole_;
  const std::uint64_t seed_;
  const Unmet unmet_;
  const Runner run_;
  std::vector<std::size_t> events_;  ///< their steps
  std::vector<nanoseconds> times_;   ///< of the events
  bool fails_before_end_ = false;    ///< in the soak's world; its end takes most of the time
};

class Search {
 public:
  Search(Story& story, const std::function<void(std::size_t)>& tell) : story_(story), tell_(tell) {}

  Cause run() {
    find_needed();
    find_seal();
    find_orders();
    return std::move(cause_);
  }

 private:
  bool counted(bool fails) {
    tell_(++cause_.runs);
    return fails;
  }
  std::vector<std::size_t> all_but(std::size_t event) const {
    std::vector<std::size_t> rest;
    for (std::size_t each = 0; each < story_.events(); ++each)
      if (each != event) rest.push_back(each);
    return rest;
  }

  void find_needed() {
    const auto fails = [this](const std::vector<std::size_t>& events) { return counted(story_.fails(events)); };
    needed_ = needed_steps(story_.events(), kMostCauseRuns, fails);
    cause_.stopped = cause_.runs >= kMostCauseRuns;
    for (const std::size_t event : needed_) cause_.needed.push_back({event, !fails(all_but(event))});
  }

  bool all_fail_after(std::size_t events) {
    for (unsigned future = 0; future < kFutures; ++future)
      if (!counted(story_.fails_after(events, future))) return false;
    return true;
  }

  // What every future fails from, they also fail from later on, since it has happened by then.
  void find_seal() {
    cause_.certain_from_start = all_fail_after(0);
    if (cause_.certain_from_start || !all_fail_after(story_.events())) return;
    std::size_t fine = 0, sealed = story_.events();
    while (sealed - fine > 1) {
      const std::size_t middle = fine + (sealed - fine) / 2;
      (all_fail_after(middle) ? sealed : fine) = middle;
    }
    cause_.sealed_by = sealed - 1;
    for (unsigned future = 0; future < kFutures; ++future)
      cause_.before += counted(story_.fails_after(fine, future)) ? 1 : 0;
  }

  void find_orders() {
    constexpr std::size_t kMostOrdered = 8;  // pairs grow with the square
    if (needed_.size() > kMostOrdered) return;
    for (std::size_t i = 0; i < needed_.size(); ++i)
      for (std::size_t j = i + 1; j < needed_.size(); ++j)
        if (!counted(story_.fails_swapped(needed_, needed_[i], needed_[j])))
          cause_.healed_by_order.emplace_back(needed_[i], needed_[j]);
  }

  Story& story_;
  const std::function<void(std::size_t)>& tell_;
  Cause cause_;
  std::vector<std::size_t> needed_;
};

std::string event_text(const Story& story, std::size_t event) {
  return "event " + std::to_string(event + 1) + ", at " + config::time_text(story.at(event)) + ": " +
         story.words(event);
}

std::string needed_text(const Cause& cause, const Story& story) {
  const std::size_t count = cause.needed.size();
  if (count == 0)
    return "It fails with none of its " + std::to_string(story.events()) + " events: the ring is enough.\n";
  std::string text = "Of its " + std::to_string(story.events()) + " events it fails with " +
                     (count == 1 ? "this one alone" : "these " + std::to_string(count) + " alone, and with no fewer") +
                     (cause.stopped ? ", or with less: the search was ended" : "") + ":\n";
  for (const Cause::Needed& needed : cause.needed)
    text += "  " + event_text(story, needed.event) +
            (needed.alone_heals ? "\n      without it the whole story does not fail\n"
                                : "\n      without it the whole story fails all the same, by other events\n");
  return text;
}

}  // namespace

Runner simulated() {
  return [](const Scenario& scenario, std::uint64_t seed, std::ostream* capture) {
    return run_scenario(scenario, seed, capture);
  };
}

std::unique_ptr<Story> story_of(const Scenario& scenario, std::uint64_t seed, Runner run) {
  const ScenarioRun first = run(scenario, seed, nullptr);
  if (!first.unmet) return nullptr;
  return std::make_unique<ScenarioStory>(scenario, seed, *first.unmet, std::move(run));
}

Cause cause_of(Story& story, const std::function<void(std::size_t runs)>& tell) { return Search(story, tell).run(); }

std::string text_of(const Cause& cause, const Story& story) {
  const std::string futures = std::to_string(kFutures);
  std::string text = needed_text(cause, story);
  if (cause.sealed_by)
    text += "From " + event_text(story, *cause.sealed_by) + "\n      every future of " + futures +
            " fails; before it " + std::to_string(cause.before) + " of " + futures + " do\n";
  else if (cause.certain_from_start)
    text += "Every future of " + futures + " fails from the start, before any event.\n";
  else
    text += "No event makes it certain: even after the last one some of " + futures + " futures do not fail.\n";
  for (const auto& [one, other] : cause.healed_by_order)
    text += "If events " + std::to_string(one + 1) + " and " + std::to_string(other + 1) +
            " change places, it does not fail.\n";
  return text + "(" + std::to_string(cause.runs) + " runs)\n";
}

}  // namespace limb_ring::scenario
