#include "judge/seen_ring.h"

#include <algorithm>
#include <iterator>

#include "wire/packet.h"

namespace limb_ring::promises {

bool says_untaken(wire::Outcome outcome) {
  using wire::Outcome;
  return outcome == Outcome::refused || outcome == Outcome::no_such_node || outcome == Outcome::rejected;
}

bool SeenNode::has_pending(const Flow& flow) const {
  return std::any_of(pending.begin(), pending.end(), [&](const Pending& one) {
    return one.seen.kind != Observation::Kind::passed && one.seen.source == flow.source && one.seen.queue == flow.queue;
  });
}

// What is taken next mostly follows what was taken last: a search through all of them would go through memory that no
// cache holds.
std::deque<Sent>::iterator Flow::first_after(std::uint64_t index) {
  const auto begin = sends.begin();
  auto it = begin + static_cast<std::ptrdiff_t>(found);
  if (it != begin && index < std::prev(it)->index)
    it = std::upper_bound(begin, it, index, [](std::uint64_t i, const Sent& sent) { return i < sent.index; });
  else
    while (it != sends.end() && it->index <= index) ++it;
  found = static_cast<std::size_t>(it - begin);
  return it;
}

void Flow::pop_front() {
  sends.pop_front();
  for (std::size_t* place : {&first_open, &first_unjudged, &found})
    if (*place != 0) --*place;
}

void Flow::clear() {
  sends.clear();
  first_open = first_unjudged = found = 0;
}

Flow* SeenRing::find_flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination) const {
  const auto& flows = nodes[source].flows;
  return flows.empty() ? nullptr : flows[queue * kNodes + destination].get();
}

Flow& SeenRing::flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination) {
  auto& flows = nodes[source].flows;
  if (flows.empty()) flows.resize(kQueues * kNodes);
  auto& found = flows[queue * kNodes + destination];
  if (!found) found = std::make_unique<Flow>(Flow{source, queue, destination, {}});
  return *found;
}

std::uint64_t& SeenRing::newest(std::uint8_t receiver, std::uint8_t source, std::uint8_t queue) {
  auto& all = nodes[receiver].newest;
  if (all.empty()) all.resize(kNodes * kQueues);
  return all[source * kQueues + queue];
}

std::string name_of(const Observation& packet, std::uint8_t source) {
  const bool interrupt = packet.queue == Observation::kInterrupt;
  const std::string to = packet.destination == wire::kBroadcast ? "all" : std::to_string(packet.destination);
  return (interrupt ? "INTP of node " : "DATP of node ") + std::to_string(source) + " to " + to +
         (interrupt ? ", factor " + std::to_string(packet.channel)
                    : ", priority " + std::to_string(packet.queue) + ", channel " + std::to_string(packet.channel) +
                          ", " + std::to_string(packet.size) + " bytes");
}

std::string name_of(const Flow& flow, const Sent& sent) {
  return name_of(sent.asked, flow.source) + ", token " + std::to_string(sent.asked.token);
}

}  // namespace limb_ring::promises
