#include "sim/recorded_story.h"

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include "config/quantity.h"
#include "judge/replay.h"
#include "sim/resumed_ring.h"
#include "wire/pcapng.h"

namespace limb_ring::sim {

using core::Time;
using promises::Breach;
using std::chrono::nanoseconds;

namespace {

/// Nobody reads more digits.
nanoseconds in_microseconds(nanoseconds time) { return std::chrono::duration_cast<std::chrono::microseconds>(time); }

/// So many broken promises are looked at until one comes again.
constexpr std::size_t kMostBreaches = 4;

/// The same packet breaks the same promise. The HOP of one that circles depends on times.
bool alike(const Breach& one, const Breach& other) {
  const bool same_words = one.promise == promises::Promise::no_circling || one.what == other.what;
  return one.promise == other.promise && one.node == other.node && one.source == other.source && same_words;
}

class WindowStory final : public scenario::Story {
 public:
  WindowStory(RecordedWindow window, const Breach& breach, const RecordedJudging& judging)
      : window_(std::move(window)),
        breach_(breach),
        judging_(judging),
        recorded_(events_of(window_, Time{nanoseconds(breach.at_ns)})) {}

  std::size_t events() const override { return all().size(); }
  nanoseconds at(std::size_t event) const override {
    return in_microseconds(core::whole_nanoseconds(all()[event].at.time_since_epoch()) - window_.recorded_from);
  }
  std::string words(std::size_t event) const override { return all()[event].words; }

  bool fails(const std::vector<std::size_t>& events) override { return fails_told(kept_of(events)); }
  bool fails_swapped(const std::vector<std::size_t>& events, std::size_t one, std::size_t other) override {
    if (all()[one].calls.empty() || all()[other].calls.empty()) return true;  // where a slice is lost is not a time
    Retelling told = kept_of(events);
    told.later.resize(all().size());
    told.later[one] = all()[other].at - all()[one].at;
    told.later[other] = all()[one].at - all()[other].at;
    told.exact_until = std::min({told.exact_until, all()[one].first, all()[other].first});
    return fails_told(std::move(told));
  }
  bool fails_after(std::size_t events, unsigned future) override {
    std::mt19937_64 random(future);
    Retelling told;
    for (std::size_t event = 0; event < all().size(); ++event)
      told.kept.push_back(event < events || goes_on(event, future, random));
    told.exact_until = events == all().size() ? window_.calls.size() : all()[events].first;
    return fails_told(std::move(told));
  }
  /// Whether it fails with all of its events if no time is as it was recorded.
  bool fails_freely() {
    Retelling told;
    told.kept.assign(all().size(), true);
    return fails_told(std::move(told));
  }
  /// When the source of the broken promise had asked for the oldest send that was under way at the begin.
  std::optional<nanoseconds> oldest_open_send() const {
    std::vector<promises::Observation> open;
    for (const RecordedWindow::Told& told : window_.told) {
      if (told.node != breach_.source) continue;
      if (told.kind != RecordedWindow::Told::Kind::sees) open.clear();
      if (told.seen.kind == promises::Observation::Kind::asked) open.push_back(told.seen);
      if (told.seen.kind != promises::Observation::Kind::ended) continue;
      const auto ended =
          std::find_if(open.begin(), open.end(), [&](const auto& one) { return one.same_send(told.seen); });
      if (ended != open.end()) open.erase(ended);
    }
    if (open.empty()) return std::nullopt;
    return nanoseconds(open.front().at_ns);
  }

 private:
  const std::vector<RecordedEvent>& all() const { return recorded_.events; }
  bool goes_on(std::size_t event, unsigned future, std::mt19937_64& random) const {
    if (future == 0) return false;
    return future == 1 ? !all()[event].is_fault : random() % 2 == 0;
  }
  Retelling kept_of(const std::vector<std::size_t>& events) const {
    Retelling told;
    told.kept.resize(all().size());
    for (const std::size_t event : events) told.kept[event] = true;
    told.exact_until = window_.calls.size();
    for (std::size_t event = 0; event < all().size(); ++event)
      if (!told.kept[event]) told.exact_until = std::min(told.exact_until, all()[event].first);
    return told;
  }
  bool fails_told(Retelling told) {
    told.until = Time{nanoseconds(breach_.at_ns)};
    const std::int64_t begin = core::whole_nanoseconds(window_.begin.time_since_epoch()).count();
    return retell(window_, recorded_, told, judging_,
                  [&](const Breach& breach) { return breach.at_ns >= begin && alike(breach, breach_); });
  }

  const RecordedWindow window_;
  const Breach breach_;
  const RecordedJudging judging_;
  const RecordedEvents recorded_;
};

/// What was judged of all that was recorded.
struct Judged {
  nanoseconds began{0};     ///< the first record
  nanoseconds complete{0};  ///< from then on every life is recorded that was there
  std::vector<Breach> breaches;
  nanoseconds try_timeout{0};                 ///< of one try
  std::map<std::uint8_t, std::string> names;  ///< of nodes
};

std::unique_ptr<recorder::ReplayedRing> open(const std::string& folder) {
  try {
    return std::make_unique<recorder::ReplayedRing>(folder);
  } catch (const std::runtime_error& problem) {
    throw UnreadableRecording(problem.what());
  }
}

Judged judge_all(const std::string& folder, const RecordedJudging& judging,
                 const std::function<void(const std::string&)>& tell) {
  auto ring_there = open(folder);
  recorder::ReplayedRing& ring = *ring_there;
  recorder::ReplayedPromises promises(ring, judging.times, judging.goes_on, judging.round);
  Judged judged;
  judged.began = judged.complete = ring.began();
  for (const auto& life : ring.lives()) judged.names[life->node()] = life->title().node;
  for (const auto& life : ring.lives())
    if (!life->from_its_start()) judged.complete = std::max(judged.complete, life->began() + nanoseconds(1));
  judged.try_timeout = core::whole_nanoseconds(ring.lives().front()->title().settings.send_timeout());
  std::uint64_t records = 0;
  constexpr std::uint64_t kTellEvery = 4096;
  while (recorder::ReplayedLife* life = ring.step(nanoseconds(std::numeric_limits<std::int64_t>::max() / 2))) {
    promises.has_done(*life);
    if (++records % kTellEvery == 0) tell("replayed " + std::to_string(records) + " records");
  }
  promises.finish();
  for (const auto& life : ring.lives())
    if (life->replay().difference())
      throw UnreadableRecording(life->file() +
                                ": is not replayed exactly; 'ringctl record check' shows the difference");
  judged.breaches = promises.breaches();
  return judged;
}

void note_breach(RecordedStory& found, const Judged& judged, const Breach& breach) {
  found.breach = breach;
  found.node = judged.names.at(breach.node);
  found.broken_after = in_microseconds(nanoseconds(breach.at_ns) - judged.began);
}

/// Looks for the span before a broken promise that is enough to break it.
class SpanSearch {
 public:
  SpanSearch(const std::string& folder, const RecordedJudging& judging,
             const std::function<void(const std::string&)>& tell, const Judged& judged, const Breach& breach)
      : folder_(folder), judging_(judging), tell_(tell), judged_(judged), breach_(breach) {}

  /// @return false if it breaks in none
  bool search(RecordedStory& found) {
    search_longer();
    if (!story_) search_shorter();
    if (!story_) return false;
    reach_back();
    note_breach(found, judged_, breach_);
    found.from = in_microseconds(begin_ - judged_.began);
    found.story = std::move(story_);
    return true;
  }

 private:
  /// From one span to the next.
  static constexpr int kTimes = 4;
  /// Spans shorter than the first that are tried.
  static constexpr int kShorter = 8;

  nanoseconds begin_of(nanoseconds span) const { return std::max(nanoseconds(breach_.at_ns) - span, judged_.complete); }
  // Until it does not fail without its events: then what it needs is among them.
  void search_longer() {
    for (nanoseconds span = judged_.try_timeout;; span *= kTimes) {
      const nanoseconds begin = begin_of(span);
      auto story = read(begin);
      if (story->events() > kMostRecordedEvents) return;
      const bool fails = story->fails_freely();
      const bool is_enough = fails && !story->fails(std::vector<std::size_t>{});
      if (fails) take(std::move(story), begin);
      if (is_enough || begin == judged_.complete) return;
    }
  }
  // The shorter it is, the more is as it was recorded.
  void search_shorter() {
    nanoseconds span = judged_.try_timeout / kTimes;
    for (int i = 0; i < kShorter && !story_; ++i, span /= kTimes) {
      auto story = read(begin_of(span));
      if (story->fails_freely()) take(std::move(story), begin_of(span));
    }
  }
  // What its source had asked for and was under way then may be what it is about.
  void reach_back() {
    const auto asked = story_->oldest_open_send();
    if (!asked || *asked < judged_.complete || *asked >= begin_) return;
    auto story = read(*asked);
    if (story->events() <= kMostRecordedEvents && story->fails_freely()) take(std::move(story), *asked);
  }
  void take(std::unique_ptr<WindowStory> story, nanoseconds begin) {
    story_ = std::move(story);
    begin_ = begin;
  }
  std::unique_ptr<WindowStory> read(nanoseconds begin) {
    tell_("what was recorded in the last " + config::time_text(in_microseconds(nanoseconds(breach_.at_ns) - begin)) +
          " before the promise was broken");
    return std::make_unique<WindowStory>(
        read_window(folder_, begin, nanoseconds(breach_.at_ns) + judged_.try_timeout, judging_), breach_, judging_);
  }

  const std::string& folder_;
  const RecordedJudging& judging_;
  const std::function<void(const std::string&)>& tell_;
  const Judged& judged_;
  const Breach& breach_;
  std::unique_ptr<WindowStory> story_;
  nanoseconds begin_{0};
};

/// Writes the states of nodes, from one instant on.
class StateWriter {
 public:
  StateWriter(const recorder::ReplayedRing& ring, nanoseconds from, std::ostream& out)
      : from_(from), writer_(out, names_of(ring)) {}

  void has_done(recorder::ReplayedLife& life, nanoseconds at) {
    if (at >= from_) begin();
    const auto* event = std::get_if<core::Event>(&life.replay().last().what);
    const auto* change = event == nullptr ? nullptr : std::get_if<core::StateChanged>(&event->what);
    if (change == nullptr) return;
    states_[life.node()] = std::string(to_string(change->before)) + " -> " + to_string(change->after);
    if (begun_) writer_.event((at - from_).count(), life.node(), states_[life.node()]);
  }
  /// Those that nodes had at the begin.
  void begin() {
    if (std::exchange(begun_, true)) return;
    for (const auto& [node, state] : states_) writer_.event(0, node, state);
  }

 private:
  static capture::RingNames names_of(const recorder::ReplayedRing& ring) {
    capture::RingNames names{ring.lives().front()->title().ring, {}};
    for (const auto& life : ring.lives()) names.nodes[life->node()] = life->title().node;
    return names;
  }

  const nanoseconds from_;
  capture::PcapngWriter writer_;
  std::map<wire::NodeId, std::string> states_;
  bool begun_ = false;
};

}  // namespace

void capture_states(const std::string& folder, nanoseconds from, nanoseconds until, std::ostream& out) {
  const auto ring = open(folder);
  StateWriter states(*ring, from, out);
  while (recorder::ReplayedLife* life = ring->step(until))
    states.has_done(*life, ring->after(life->machine_time(life->replay().now())));
  states.begin();
}

RecordedStory story_of(const std::string& folder, const RecordedJudging& judging,
                       const std::function<void(const std::string&)>& tell) {
  const Judged judged = judge_all(folder, judging, tell);
  RecordedStory found;
  if (judged.breaches.empty()) return found;
  note_breach(found, judged, judged.breaches.front());
  found.why_not = "when it was broken, not all nodes were recorded yet";
  std::size_t tried = 0;
  for (const Breach& breach : judged.breaches) {
    if (nanoseconds(breach.at_ns) <= judged.complete) continue;
    if (SpanSearch(folder, judging, tell, judged, breach).search(found) || ++tried == kMostBreaches) break;
    found.why_not = "the same events, done once more, do not break it: it needs the very times of the living ring";
  }
  return found;
}

}  // namespace limb_ring::sim
