#include "judge/promise_judge.h"

#include <algorithm>
#include <utility>

#include "wire/packet.h"

namespace limb_ring::promises {

using Kind = Observation::Kind;
using wire::Outcome;

void Arrivals::taken(std::uint8_t id, const Observation& seen) {
  ++report_.counts.packets;
  SeenNode& node = ring_.at(id);
  if (seen.destination != id && seen.destination != wire::kBroadcast)
    return report_.break_promise(Promise::undamaged, id, seen.source, seen.at_ns,
                                 name_of(seen, seen.source) + ", was given to the CPU of node " + std::to_string(id));
  const Pending came{seen, ring_.round, node.life, node.empty_at};
  // While one waits for its send to be seen, later ones have to wait as well, because their order is judged.
  if (!node.pending.empty() || !match(id, came, false)) node.pending.push_back(came);
}

/// Perhaps: whoever reads late finds seconds in one round, and a send that ended in the round in which the receiver
/// became known may have been taken before that or after it.
bool Arrivals::ended_before_known(std::uint8_t receiver, const Sent& sent) const {
  return sent.ended && sent.ended_round <= ring_.at(receiver).known_round;
}

/// The first send of this content that was not taken yet; if its content tells it from all others, after the one
/// that the receiver took last. One that is open, was delivered, or is a broadcast that some refused, is preferred; one
/// that ended otherwise counts only when every possible cause has been seen. As a pin is pulled at once, so does the
/// INTP of one if it ended long ago.
Sent* Arrivals::find(std::uint8_t receiver, Flow* flow, const Pending& came, bool all_asked) const {
  const Observation& seen = came.seen;
  Alike* alike = flow == nullptr ? nullptr : flow->find_alike(seen);
  if (alike == nullptr) return nullptr;
  Sent* old = nullptr;
  for (Sent& sent : *alike) {
    if ((sent.ended && sent.tries == 0 && !sent.cut_short) || ended_before_known(receiver, sent)) continue;
    const std::uint16_t taken = sent.taken_in(receiver);
    if (taken != 0 && (sent.ended || taken == came.life)) continue;
    const bool just_ended = sent.ended_round + 2 >= ring_.round && !sent.is_untaken();
    const bool by_some = sent.outcome == Outcome::delivered || (sent.by_node && sent.outcome == Outcome::refused);
    if (!sent.ended || (seen.kind == Kind::pin ? just_ended : by_some)) return &sent;
    if (all_asked && old == nullptr) old = &sent;
  }
  return old;
}

// A pulled pin does not show whether the INTP was a broadcast, so both flows are searched.
/// @param all_asked its send, if there was one, has been seen by now
bool Arrivals::match(std::uint8_t receiver, const Pending& came, bool all_asked) {
  const Observation& seen = came.seen;
  const bool pin = seen.kind == Kind::pin;
  Flow* const flow = ring_.find_flow(seen.source, seen.queue, seen.destination);
  Sent* sent = find(receiver, flow, came, all_asked);
  if (pin && seen.source != receiver) {
    Sent* to_all = find(receiver, ring_.find_flow(seen.source, seen.queue, wire::kBroadcast), came, all_asked);
    const auto is_open = [](const Sent& one) { return !one.ended; };
    const bool rather = to_all != nullptr && sent != nullptr &&
                        (is_open(*to_all) != is_open(*sent) ? is_open(*to_all) : to_all->index < sent->index);
    if (sent == nullptr || rather) sent = to_all;
  }
  if (sent == nullptr) return false;
  if (!pin && flow->find_alike(seen)->size() == 1 && !ring_.has_former(*flow, receiver, seen)) {
    std::uint64_t& newest = ring_.newest(receiver, seen.source, seen.queue);
    if (sent->index <= newest) return false;
    newest = sent->index;
  }
  sent->taken_in(receiver) = came.life;
  sent->taken_at = seen.at_ns;
  // It may have been one that was asked for unseen: then this one is still to come.
  if (!certain(receiver, came))
    ++ring_.at(receiver)
          .former[SeenRing::key(*ring_.find_flow(seen.source, seen.queue, sent->asked.destination), seen)]
          .untaken;
  return true;
}

void Arrivals::settle(std::uint8_t receiver) {
  auto& pending = ring_.at(receiver).pending;
  std::bitset<kNodes * kQueues> waits;  // by source and queue: one of these still waits for its send
  for (std::size_t left = pending.size(); left != 0; --left) {
    const Pending next = pending.front();
    pending.pop_front();
    const std::size_t from = next.seen.source * kQueues + next.seen.queue;
    const bool pass = next.seen.kind == Kind::passed, all_asked = next.round != ring_.round;
    if (!waits[from] && (pass ? mark_passed(receiver, next.seen) : match(receiver, next, all_asked))) continue;
    if (!all_asked) {
      waits[from] = waits[from] || !pass;
      pending.push_back(next);
    } else if (!pass) {
      classify(receiver, next);
    }
  }
}

/// True if no unseen send of that source can still have been under way.
bool Arrivals::certain(std::uint8_t receiver, const Pending& pending) const {
  const SeenNode& from = ring_.at(pending.seen.source);
  const SeenNode& to = ring_.at(receiver);
  if (!from.known || from.closing || !to.known) return false;
  const std::int64_t proven = from.proven_at[pending.seen.queue];
  const std::int64_t at_last = from.known_at + from.longest_send;
  const std::int64_t all_seen = proven == 0 ? at_last : std::min(proven, at_last);
  const std::int64_t came_after = pending.seen.kind == Kind::pin ? pending.seen.at_ns : pending.empty_at;
  return came_after >= std::max(all_seen, to.known_at) + times_.copies_last.count();
}

void Arrivals::classify(std::uint8_t receiver, const Pending& pending) {
  const Observation& seen = pending.seen;
  if (!certain(receiver, pending)) return void(report_.leave_unjudged(Unjudged::source_unknown));
  const bool pin = seen.kind == Kind::pin;
  if (judge_alike(receiver, pending, ring_.find_flow(seen.source, seen.queue, seen.destination))) return;
  if (pin && judge_alike(receiver, pending, ring_.find_flow(seen.source, seen.queue, wire::kBroadcast))) return;
  report_.break_promise(Promise::undamaged, receiver, seen.source, seen.at_ns,
                        name_of(seen, seen.source) + ", " + (pin ? "has pulled a pin of" : "was taken by") + " node " +
                            std::to_string(receiver) + ", and was not asked for");
}

/// Reports something that came again although every send of its content was taken already, or that came out of order.
/// @return false if nothing of that content was asked for in that flow
bool Arrivals::judge_alike(std::uint8_t receiver, const Pending& came, Flow* from) {
  const Observation& seen = came.seen;
  Alike* const those = from == nullptr ? nullptr : from->find_alike(seen);
  if (those == nullptr) return false;
  const auto has_left = [](const Sent& sent) { return !sent.ended || sent.tries != 0 || sent.cut_short; };
  const auto found = std::find_if(those->rbegin(), those->rend(), has_left);
  if (found == those->rend()) return false;
  if (ring_.stands_for_former(*from, receiver, seen)) return report_.leave_unjudged(Unjudged::alike);
  const std::uint16_t taken = std::exchange(found->taken_in(receiver), came.life);
  if (taken != 0 && taken != came.life) return true;  // a late copy, in another life of the receiver
  const bool twice = taken == came.life;
  if (!twice && ended_before_known(receiver, *found)) return report_.leave_unjudged(ring_.at(receiver).before);
  const std::string by = " node " + std::to_string(receiver);
  const std::string what = !twice                   ? ", was taken by" + by + " after one that was asked for later"
                           : seen.kind == Kind::pin ? ", has pulled its pin twice at" + by
                                                    : ", was taken twice by" + by;
  report_.break_promise(twice ? Promise::exactly_once : Promise::in_order, receiver, seen.source, seen.at_ns,
                        name_of(*from, *found) + what);
  return true;
}

void Arrivals::passed(std::uint8_t id, const Observation& seen) {
  ring_.at(id).pending.push_back({seen, ring_.round, 0, 0});
}

bool Arrivals::mark_passed(std::uint8_t id, const Observation& seen) {
  Flow* from = ring_.find_flow(seen.source, seen.queue, wire::kBroadcast);
  Alike* alike = from == nullptr ? nullptr : from->find_alike(seen);
  if (alike == nullptr) return false;
  const auto next =
      std::find_if(alike->begin(), alike->end(), [id](const Sent& sent) { return !sent.by_node->passed[id]; });
  if (next == alike->end()) return false;
  next->by_node->passed.set(id);
  return true;
}

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
  Sent& sent = to.add(seen);
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
        if (!sent.ended) sent.cut(ring_.round, node.at);
}

void Sends::forget(std::uint8_t id, Unjudged why) {
  for (auto& flow : ring_.at(id).flows) {
    if (!flow) continue;
    for (const Sent& sent : flow->sends)
      if (!sent.judged) report_.leave_unjudged(why);
    flow->clear();
  }
  for (SeenNode& receiver : ring_.nodes)
    for (auto it = receiver.former.begin(); it != receiver.former.end();)
      it = std::get<0>(it->first) == id ? receiver.former.erase(it) : std::next(it);
}

void PromiseJudge::begins(std::uint8_t id, std::uint8_t state, std::chrono::nanoseconds longest_send,
                          std::int64_t at_ns) {
  ends(id);  // a former life of which nobody has said so
  SeenNode& node = ring_.at(id);
  node.before = node.seen_before ? Unjudged::receiver_restarted : Unjudged::receiver_unknown;
  node.seen_before = true;
  looks_at(id, state, longest_send, at_ns);
}

void PromiseJudge::looks_at(std::uint8_t id, std::uint8_t state, std::chrono::nanoseconds longest_send,
                            std::int64_t at_ns) {
  SeenNode& node = ring_.at(id);
  node.known = true;
  node.closing = node.after_loss = false;
  ring_.known.push_back(id);
  node.known_round = node.state_round = ring_.round;
  node.known_at = node.at = at_ns;
  node.empty_round = node.flushed_round = 0;
  node.empty_at = 0;
  node.longest_send = longest_send.count();
  node.state = state;
  ++node.life;
  node.proven_at.fill(0);
  node.newest.clear();
  node.former.clear();
  for (const Pending& pending : node.pending)
    if (pending.seen.kind != Kind::passed) report_.leave_unjudged(node.before);
  node.pending.clear();
}

void PromiseJudge::ends(std::uint8_t id) {
  ring_.at(id).after_loss = false;
  if (!ring_.at(id).known) return;
  leaves(id);
  sends_.cut_short(id);
}

void PromiseJudge::leaves(std::uint8_t id) {
  SeenNode& node = ring_.at(id);
  node.known = false;
  ring_.known.erase(std::remove(ring_.known.begin(), ring_.known.end(), id), ring_.known.end());
  node.proven_at.fill(0);
}

void PromiseJudge::lost(std::uint8_t id, std::uint64_t count) {
  SeenNode& node = ring_.at(id);
  report_.counts.lost += count;
  sends_.forget(id, Unjudged::observations_lost);
  ends(id);
  node.before = Unjudged::observations_lost;
  node.after_loss = true;
}

void PromiseJudge::see(std::uint8_t id, const Observation& seen) {
  SeenNode& node = ring_.at(id);
  if (node.after_loss) looks_at(id, node.state, std::chrono::nanoseconds(node.longest_send), seen.at_ns);
  if (!node.known) return;
  node.alive += std::clamp<std::int64_t>(seen.at_ns - node.at, 0, times_.step.count());
  node.at = seen.at_ns;
  node.seen_round = ring_.round;
  switch (seen.kind) {
    case Kind::asked:
      return sends_.asked(id, seen);
    case Kind::ended:
      return sends_.ended(id, seen);
    case Kind::taken:
    case Kind::pin:
      return arrivals_.taken(id, seen);
    case Kind::passed:
      return arrivals_.passed(id, seen);
    case Kind::circles:
      return report_.break_promise(Promise::no_circling, id, seen.source, seen.at_ns,
                                   "a packet of node " + std::to_string(seen.source) + " with HOP " +
                                       std::to_string(seen.size) + " came into node " + std::to_string(id) +
                                       ": it has gone round");
    case Kind::flushed:
      node.flushed_round = ring_.round;
      return;
    case Kind::state:
      return changed_state(id, seen.detail);
    case Kind::goes_on:
      if (seen.detail == 0) return;
      node.empty_round = ring_.round;
      node.empty_at = seen.at_ns;
      return;
  }
}

void PromiseJudge::changed_state(std::uint8_t id, std::uint8_t after) {
  SeenNode& node = ring_.at(id);
  node.state = after;
  node.state_round = ring_.round;
}

void PromiseJudge::round_is_over() {
  for (const std::uint8_t id : ring_.known) arrivals_.settle(id);
  for (Flow* flow : ring_.active) result_judge_.settle(*flow);
  const auto is_idle = [](Flow* flow) {
    if (!flow->sends.empty()) return false;
    flow->listed = false;
    return true;
  };
  ring_.active.erase(std::remove_if(ring_.active.begin(), ring_.active.end(), is_idle), ring_.active.end());
  ++ring_.round;
}

}  // namespace limb_ring::promises
