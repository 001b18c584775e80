#include "study/exploration.h"

#include <algorithm>

#include "io/in_parallel.h"

namespace limb_ring::study {

// Each thread takes one first strike after another and explores everything that can follow it.
void Exploration::run(const Progress& progress) {
  const std::vector<Choice> firsts = next({}, run_once({}, progress));
  process::in_parallel(firsts.size(), bounds_.threads, [&](std::size_t i) {
    if (stop_) return;
    std::vector<Choice> choices{firsts[i]};
    extend(choices, progress);
  });
}

void Exploration::extend(std::vector<Choice>& choices, const Progress& progress) {
  for (const Choice& choice : next(choices, run_once(choices, progress))) {
    if (stop_) return;
    choices.push_back(choice);
    extend(choices, progress);
    choices.pop_back();
  }
}

// If places are bounded, two runs in the same state may be at different places, so that more can still strike in one of
// them. Then states are recognised only once nothing more may strike. @return places in that run
unsigned Exploration::run_once(const std::vector<Choice>& choices, const Progress& progress) {
  ExploredRun run(world_, choices);
  const bool bounded = bounds_.places < kAllPlaces;
  const auto left = bounded ? 0 : bounds_.faults - static_cast<unsigned>(choices.size());
  if (bounds_.recognise) run.recognise(states_, ++begun_, left);
  run.run();
  const std::lock_guard<std::mutex> lock(mutex_);
  ++runs_;
  recognised_ += run.recognised() ? 1 : 0;
  places_ = std::max(places_, run.places());
  if (run.violation() && !found_) found_ = Found{choices, *run.violation()};
  if (found_) stop_ = true;
  progress();
  return run.places();
}

/// What may strike next in such a run.
std::vector<Choice> Exploration::next(const std::vector<Choice>& choices, unsigned places) const {
  std::vector<Choice> all;
  if (choices.size() == bounds_.faults || stop_) return all;
  for (unsigned place = choices.empty() ? 0 : choices.back().place + 1; place < std::min(places, bounds_.places);
       ++place)
    for (const Strike& strike : strikes()) all.push_back({place, strike});
  return all;
}

// No doubling in a ring that folds back: a fold may bring the copy after its source's next packet, which the lines of a
// ring never do. And no cut where the ring is broken already.
std::vector<Strike> Exploration::strikes() const {
  using What = Strike::Kind;
  std::vector<Strike> all;
  for (const What kind :
       {What::lost, What::header_damaged, What::data_damaged, What::end_damaged, What::doubled, What::late})
    if (kind != What::doubled || !world_.fold_back) all.push_back({kind, wire::NodeId{0}});
  for (const What kind : {What::restart, What::freeze, What::cut, What::interrupt})
    for (unsigned node = 0; node < world_.nodes; ++node)
      if (kind != What::cut || !world_.broken || node != world_.last_node())
        all.push_back({kind, static_cast<wire::NodeId>(node)});
  return all;
}

}  // namespace limb_ring::study
