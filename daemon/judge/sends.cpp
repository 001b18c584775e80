#include "judge/sends.h"

#include "wire/packet.h"

namespace limb_ring::promises {

using wire::Outcome;

namespace {

/// Of one flow, at most so many are kept.
constexpr std::size_t kMost = 20000;

}  // namespace

void Sends::asked(std::uint8_t id, const Observation& seen) {
  ++report_.counts.sends;
  SeenNode& node = ring_.at(id);
  Flow& to = ring_.flow(id, seen.queue, seen.destination);
  if (to.sends.size() >= kMost) {
    if (!to.sends.front().judged) report_.leave_unjudged(Unjudged::too_many);
    to.pop_front();
    node.known_at = seen.at_ns;  // its end is not known any more
    node.proven_at.fill(0);
  }
  Sent& sent = to.sends.emplace_back();
  sent.asked = seen;
  sent.index = ++node.asked[seen.queue];
  sent.asked_round = ring_.round;
  sent.asked_alive = node.alive;
  if (seen.destination == wire::kBroadcast) sent.by_node = std::make_unique<ByNode>();
  if (to.listed) return;
  to.listed = true;
  ring_.active.push_back(&to);
}

/// Visits the flows in which a send that has ended may be. visit(flow) returns true to stop.
template <class Visit>
bool Sends::any_flow(std::uint8_t id, const Observation& ended, Visit visit) {
  const bool interrupt = ended.queue == Observation::kInterrupt;
  for (std::uint8_t queue = interrupt ? Observation::kInterrupt : 0; queue < (interrupt ? kQueues : 4); ++queue)
    if (Flow* flow = ring_.find_flow(id, queue, ended.destination); flow != nullptr && visit(*flow)) return true;
  return false;
}

Sent* Sends::find_open(std::uint8_t id, const Observation& seen) {
  Sent* found = nullptr;
  any_flow(id, seen, [&](Flow& flow) {
    while (flow.first_open < flow.sends.size() && flow.sends[flow.first_open].ended) ++flow.first_open;
    for (std::size_t i = flow.first_open; i < flow.sends.size() && found == nullptr; ++i)
      if (!flow.sends[i].ended && flow.sends[i].asked.same_send(seen)) found = &flow.sends[i];
    return found != nullptr;
  });
  return found;
}

void Sends::ended(std::uint8_t id, const Observation& seen) {
  Sent* sent = find_open(id, seen);
  if (sent == nullptr) return ended_again(id, seen);
  sent->end(static_cast<Outcome>(seen.detail), ring_.round, seen.at_ns);
  sent->tries = seen.tries;
  if (leaves_open(sent->outcome)) ring_.flow(id, sent->asked.queue, sent->asked.destination).doubt(*sent);
  const bool was_out = seen.tries != 0 && sent->outcome != Outcome::cancelled;
  std::int64_t& proven = ring_.at(id).proven_at[sent->asked.queue];
  // Sends of a queue go in order, so all that were asked for before we began to observe have ended by now.
  if (was_out && proven == 0) proven = seen.at_ns;
}

// A daemon that was started again gives the same tokens again, and of its first sends only the ends may be seen.
void Sends::ended_again(std::uint8_t id, const Observation& seen) {
  const SeenNode& node = ring_.at(id);
  const bool had_ended = any_flow(id, seen, [&](Flow& flow) {
    for (const Sent& sent : flow.sends) {
      if (sent.cut_short || sent.asked.at_ns < node.known_at || !sent.asked.same_send(seen)) continue;
      report_.break_promise(Promise::one_result, id, id, seen.at_ns, name_of(flow, sent) + " has two results");
      return true;
    }
    return false;
  });
  if (had_ended) return;
  if (seen.at_ns - node.known_at < node.longest_send + times_.copies_last.count())
    return void(report_.leave_unjudged(Unjudged::source_unknown));
  report_.break_promise(Promise::one_result, id, id, seen.at_ns,
                        "a send of node " + std::to_string(id) + " to " + std::to_string(seen.destination) +
                            " ended, and nobody had asked for it, or it had ended long before");
}

void Sends::cut_short(std::uint8_t id) {
  SeenNode& node = ring_.at(id);
  for (auto& flow : node.flows)
    if (flow)
      for (Sent& sent : flow->sends)
        if (!sent.ended) {
          sent.cut(ring_.round, node.at);
          flow->doubt(sent);
        }
}

void Sends::forget(std::uint8_t id, Unjudged why) {
  for (auto& flow : ring_.at(id).flows) {
    if (!flow) continue;
    for (const Sent& sent : flow->sends)
      if (!sent.judged) report_.leave_unjudged(why);
    flow->clear();
  }
}

}  // namespace limb_ring::promises
