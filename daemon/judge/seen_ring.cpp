#include "judge/seen_ring.h"

#include <algorithm>
#include <numeric>

#include "wire/packet.h"

namespace limb_ring::promises {

bool Sent::is_untaken() const {
  using wire::Outcome;
  if (!ended || cut_short) return false;
  return tries == 0 || outcome == Outcome::rejected || outcome == Outcome::no_such_node ||
         (outcome == Outcome::refused && !by_node);
}

bool SeenNode::has_pending(const Flow& flow) const {
  return std::any_of(pending.begin(), pending.end(), [&](const Pending& one) {
    return one.seen.kind != Observation::Kind::passed && one.seen.source == flow.source && one.seen.queue == flow.queue;
  });
}

Sent& Flow::add(const Observation& asked) {
  Sent& sent = sends.emplace_back();
  sent.asked = asked;
  alike[content_of(asked)].push_back(sent);
  return sent;
}

Alike* Flow::find_alike(const Observation& like) {
  const auto found = alike.find(content_of(like));
  return found == alike.end() ? nullptr : &found->second;
}

void Flow::pop_front() {
  const auto of_it = alike.find(content_of(sends.front().asked));
  of_it->second.pop_front();
  if (of_it->second.empty()) alike.erase(of_it);
  sends.pop_front();
  for (std::size_t* place : {&first_open, &first_unjudged})
    if (*place != 0) --*place;
}

void Flow::clear() {
  alike.clear();
  sends.clear();
  first_open = first_unjudged = 0;
}

namespace {

bool move_one(unsigned& from, unsigned& to) {
  if (from == 0) return false;
  --from;
  ++to;
  return true;
}

}  // namespace

bool SeenRing::stands_for_former(const Flow& flow, std::uint8_t receiver, const Observation& taken) {
  const auto former = at(receiver).former.find(key(flow, taken));
  return former != at(receiver).former.end() && move_one(former->second.untaken, former->second.taken);
}

bool SeenRing::former_stands_for(const Flow& flow, std::uint8_t receiver, const Observation& missing) {
  const auto former = at(receiver).former.find(key(flow, missing));
  return former != at(receiver).former.end() && move_one(former->second.taken, former->second.untaken);
}

Flow* SeenRing::find_flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination) const {
  const auto& flows = nodes[source].flows;
  return flows.empty() ? nullptr : flows[queue * kNodes + destination].get();
}

Flow& SeenRing::flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination) {
  auto& flows = nodes[source].flows;
  if (flows.empty()) flows.resize(kQueues * kNodes);
  auto& found = flows[queue * kNodes + destination];
  if (!found) found = std::make_unique<Flow>(Flow{source, queue, destination});
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
