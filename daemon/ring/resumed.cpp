#include "ring/resumed.h"

#include <algorithm>
#include <map>

#include "ring/arrived.h"
#include "ring/known_stops.h"

namespace limb_ring::ask {

Result resume_from_nearer(const std::string& ring, std::uint8_t target, const Result& result, const SendResume& send) {
  if (result.why != Reason::out_of_reach && result.outcome != Outcome::no_such_node) return result;
  const auto sender = who_reaches(status_rows_here(ring, kRowTimeout), target);
  if (!sender) return result;
  try {
    const Result again = send(*sender);
    return may_have_arrived(again) ? again : result;
  } catch (const HostPortError&) {  // it has gone meanwhile, or the time is up
    return result;
  }
}

void look_at(const std::string& ring, const std::vector<Node>& nodes, std::vector<Resumed>& all) {
  std::vector<Node> taken;
  for (const Resumed& one : all)
    if (may_have_arrived(one.result)) taken.push_back(one.node);
  wait_for_resumes(ring, taken);
  std::map<std::uint8_t, StopState> known;
  for (const KnownStop& stop : stops_now(ring, nodes)) known[stop.node.id] = stop.state;
  for (Resumed& one : all) {
    one.is_latched = known[one.node.id] == StopState::stopped;
    one.seen = !one.is_latched && known[one.node.id] != StopState::unknown;
  }
}

bool is_among(const std::vector<Node>& nodes, std::uint8_t id) {
  return std::any_of(nodes.begin(), nodes.end(), [id](const Node& node) { return node.id == id; });
}

}  // namespace limb_ring::ask
