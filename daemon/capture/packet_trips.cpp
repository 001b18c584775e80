#include "capture/packet_trips.h"

#include <map>
#include <utility>

namespace limb_ring::capture {

namespace {

using Key = std::pair<wire::NodeId, std::uint8_t>;  // source, Code

/// Tries of one Code that may still go on.
struct Open {
  std::size_t trip;
  unsigned stage;  ///< reached
};

/// More are under way only of a line that doubles without end: the oldest is given up then.
constexpr std::size_t kMostOpen = 8;

/// The one that was seen nearest before that stage, the youngest of several; none where it begins anew.
Open* nearest(std::vector<Open>& open, unsigned stage) {
  Open* best = nullptr;
  for (Open& one : open)
    if (one.stage < stage && (best == nullptr || one.stage >= best->stage)) best = &one;
  return best;
}

}  // namespace

std::vector<Trip> sort_into_trips(const std::vector<SeenPacket>& packets) {
  std::vector<Trip> trips;
  std::map<Key, std::vector<Open>> open;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    std::vector<Open>& of_code = open[{packets[i].source, packets[i].code}];
    const unsigned stage = packets[i].stage();
    if (Open* found = nearest(of_code, stage)) {
      trips[found->trip].seen.push_back(i);
      found->stage = stage;
      continue;
    }
    if (of_code.size() == kMostOpen) of_code.erase(of_code.begin());
    of_code.push_back({trips.size(), stage});
    trips.push_back({{i}});
  }
  return trips;
}

}  // namespace limb_ring::capture
