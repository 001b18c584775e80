#include "judge/seen_ring.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "wire/packet.h"

namespace limb_ring::promises {

bool says_untaken(wire::Outcome outcome) {
  using wire::Outcome;
  return outcome == Outcome::refused || outcome == Outcome::no_such_node || outcome == Outcome::rejected;
}

bool leaves_open(wire::Outcome outcome) { return outcome != wire::Outcome::delivered && !says_untaken(outcome); }

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

namespace {

/// Of one flow, at most so many are kept: the last ones.
constexpr std::size_t kMostDoubts = 64;

}  // namespace

void Flow::doubt(const Sent& sent) {
  if (doubts.size() == kMostDoubts) doubts.erase(doubts.begin());
  doubts.push_back({sent.asked, {}});
}

bool Flow::forgives(std::uint8_t receiver, const Observation& asked) {
  const auto open = std::find_if(doubts.begin(), doubts.end(), [&](const Doubt& doubt) {
    const bool another = !doubt.asked.same_send(asked) || doubt.asked.at_ns != asked.at_ns;
    return another && doubt.asked.same_content(asked) && !doubt.forgiven[receiver];
  });
  if (open == doubts.end()) return false;
  open->forgiven.set(receiver);
  return true;
}

bool SeenRing::forgives(const Flow& flow, std::uint8_t receiver, const Observation& asked) {
  const std::uint8_t other_way = flow.destination == wire::kBroadcast ? receiver : std::uint8_t{wire::kBroadcast};
  for (const std::uint8_t destination : {flow.destination, other_way}) {
    const bool told_apart = flow.queue != Observation::kInterrupt && destination != flow.destination;
    Flow* one = told_apart ? nullptr : find_flow(flow.source, flow.queue, destination);
    if (one != nullptr && one->forgives(receiver, asked)) return true;
  }
  return false;
}

void Flow::pop_front() {
  const Observation gone = sends.front().asked;
  sends.pop_front();
  const auto alike = [&](const Sent& sent) { return sent.asked.same_content(gone); };
  if (!doubts.empty() && std::none_of(sends.begin(), sends.end(), alike))
    doubts.erase(std::remove_if(doubts.begin(), doubts.end(),
                                [&](const Doubt& doubt) { return doubt.asked.same_content(gone); }),
                 doubts.end());
  for (std::size_t* place : {&first_open, &first_unjudged, &found})
    if (*place != 0) --*place;
}

void Flow::clear() {
  sends.clear();
  doubts.clear();
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
  if (!found) found = std::make_unique<Flow>(Flow{source, queue, destination, {}, 0, 0, 0, false, {}});
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

const char* to_string(Unjudged why) {
  switch (why) {
    case Unjudged::receiver_unknown:
      return "the receiver was not seen for long enough";
    case Unjudged::receiver_restarted:
      return "the receiver or its CPU was restarted";
    case Unjudged::source_unknown:
      return "the source was not seen for long enough";
    case Unjudged::observations_lost:
      return "observations were lost";
    case Unjudged::ring_changed:
      return "broadcasts while the ring changed";
    case Unjudged::alike:
      return "equal data of a send that may have been taken or not";
    case Unjudged::too_many:
      return "too many under way";
  }
  return "";
}

std::uint64_t JudgeCounts::all_unjudged() const {
  return std::accumulate(unjudged.begin(), unjudged.end(), std::uint64_t{0});
}

std::string describe(const JudgeCounts& counts) {
  std::string text = std::to_string(counts.sends) + " sends, " + std::to_string(counts.packets) + " packets and pins";
  const char* before = "; not judged: ";
  for (std::size_t i = 0; i < kUnjudged; ++i) {
    if (counts.unjudged[i] == 0) continue;
    text += before + std::to_string(counts.unjudged[i]) + " (" + to_string(static_cast<Unjudged>(i)) + ")";
    before = ", ";
  }
  if (counts.lost != 0) text += "; " + std::to_string(counts.lost) + " observations lost";
  return text;
}

void JudgeReport::break_promise(Promise promise, std::uint8_t node, std::uint8_t source, std::int64_t at,
                                std::string what) {
  ++counts.breaches;
  const auto [told, first] = told_.try_emplace({promise, node, source}, at);
  if (!first && at - told->second < told_again_.count()) return;
  told->second = at;
  on_breach_({promise, node, source, at, std::move(what)});
}

}  // namespace limb_ring::promises
