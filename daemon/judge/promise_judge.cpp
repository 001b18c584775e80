#include "judge/promise_judge.h"

#include <algorithm>

namespace limb_ring::promises {

using Kind = Observation::Kind;

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
