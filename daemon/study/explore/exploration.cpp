#include "study/explore/exploration.h"

#include <algorithm>

namespace limb_ring::study {

void Exploration::run(const std::function<void()>& progress) {
  std::vector<Choice> choices;
  extend(choices, progress);
}

void Exploration::extend(std::vector<Choice>& choices, const std::function<void()>& progress) {
  ExploredRun run(world_, choices);
  run.run();
  ++runs_;
  places_ = std::max(places_, run.places());
  if (run.violation()) found_ = Found{choices, *run.violation()};
  progress();
  if (choices.size() == faults_) return;
  const unsigned end = std::min(run.places(), most_places_);
  for (unsigned place = choices.empty() ? 0 : choices.back().place + 1; place < end; ++place)
    for (const Strike& strike : strikes()) {
      if (found_) return;
      choices.push_back({place, strike});
      extend(choices, progress);
      choices.pop_back();
    }
}

// A fold may bring a doubled copy behind its source's next packet, which the lines of a ring never do.
std::vector<Strike> Exploration::strikes() const {
  using Kind = Strike::Kind;
  std::vector<Strike> all;
  for (const Kind kind :
       {Kind::lost, Kind::header_damaged, Kind::data_damaged, Kind::end_damaged, Kind::doubled, Kind::late})
    if (kind != Kind::doubled || !world_.fold_back) all.push_back({kind, wire::NodeId{0}});
  for (const Kind kind : {Kind::restart, Kind::freeze, Kind::cut, Kind::interrupt})
    for (unsigned node = 0; node < world_.nodes; ++node) all.push_back({kind, static_cast<wire::NodeId>(node)});
  return all;
}

}  // namespace limb_ring::study
