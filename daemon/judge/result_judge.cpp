#include "judge/result_judge.h"

#include <algorithm>
#include <limits>

#include "wire/packet.h"

namespace limb_ring::promises {

using wire::Outcome;

namespace {

/// For so many rounds after its end, a CPU may still read a send that was not delivered.
constexpr Round kLate = 60;
/// core::NodeState::up, in which users may send into a closed ring.
constexpr std::uint8_t kUp = 2;
constexpr std::int64_t kWhenever = std::numeric_limits<std::int64_t>::max();

}  // namespace

void ResultJudge::settle(Flow& flow) {
  for (std::size_t i = flow.first_unjudged; i < flow.sends.size(); ++i) {
    Sent& sent = flow.sends[i];
    if (!sent.judged && judge(flow, sent)) {
      sent.judged = true;
      ++report_.counts.judged;
    }
    if (sent.judged && i == flow.first_unjudged) ++flow.first_unjudged;
  }
  while (!flow.sends.empty() && is_done_with(flow, flow.sends.front())) {
    flow.pop_front();
  }
}

/// Nobody can receive it any more, a second copy would have been seen by now, and so would that another send was meant.
bool ResultJudge::is_done_with(const Flow& flow, const Sent& sent) const {
  const SeenNode& source = ring_.at(flow.source);
  if (!sent.judged || !sent.ended) return false;
  if (source.known && std::max(sent.ended_at, sent.taken_at) + times_.kept.count() >= source.at) return false;
  if (may_stand_for_other(flow, sent)) return false;
  return sent.by_node ? is_over_everywhere(flow, sent)
                      : sent.taken_life != 0 || is_over_at(flow.destination, flow, sent);
}

/// Visits the other sends that look the same at the receiver: a pin does not show whether the INTP was a broadcast.
/// @param asked_until those that were asked for later are left out, by the source's clock, ns
/// @param visit returns true to stop @return whether one did
template <class Visit>
bool ResultJudge::any_alike(const Flow& flow, const Sent& sent, std::uint8_t receiver, std::int64_t asked_until,
                            Visit visit) const {
  const std::uint8_t other_way = flow.destination == wire::kBroadcast ? receiver : std::uint8_t{wire::kBroadcast};
  for (const std::uint8_t destination : {flow.destination, other_way}) {
    const bool told_apart = flow.queue != Observation::kInterrupt && destination != flow.destination;
    Flow* others = told_apart ? nullptr : ring_.find_flow(flow.source, flow.queue, destination);
    if (others == nullptr) continue;
    for (Sent& other : others->sends) {
      if (other.asked.at_ns > asked_until) break;
      if (&other != &sent && other.asked.same_content(sent.asked) && visit(other)) return true;
    }
  }
  return false;
}

/// Something of its content was taken when a send that is not judged yet had been asked for as well: taken_for_other()
/// may still have to find this one.
bool ResultJudge::may_stand_for_other(const Flow& flow, const Sent& sent) const {
  const auto any_open_at = [&](std::uint8_t receiver) {
    return any_alike(flow, sent, receiver, sent.taken_at, [](const Sent& other) { return !other.judged; });
  };
  if (!sent.by_node) return any_open_at(flow.destination);
  return std::any_of(ring_.known.begin(), ring_.known.end(), any_open_at);
}

bool ResultJudge::is_over_at(std::uint8_t receiver, const Flow& flow, const Sent& sent) const {
  const SeenNode& node = ring_.at(receiver);
  if (!node.known || node.known_round > sent.ended_round) return true;
  return (flow.queue == Observation::kInterrupt ? node.seen_round : node.empty_round) >= sent.ended_round + kLate;
}

/// @return false where that is not known yet
bool ResultJudge::judge(Flow& flow, Sent& sent) {
  if (!sent.ended) return judge_open(flow, sent);
  return sent.by_node ? judge_broadcast(flow, sent) : judge_unicast(flow, sent);
}

bool ResultJudge::judge_open(Flow& flow, Sent& sent) {
  const SeenNode& source = ring_.at(flow.source);
  if (source.alive - sent.asked_alive < source.longest_send + times_.copies_last.count()) return false;
  sent.cut(ring_.round, source.at);
  report_.break_promise(Promise::one_result, flow.source, flow.source, source.at,
                        name_of(flow, sent) + " has not ended");
  return true;
}

bool ResultJudge::judge_unicast(Flow& flow, Sent& sent) {
  if (sent.taken_life == ring_.at(flow.destination).life) return judge_taken(flow, sent);
  if (sent.taken_life != 0) return true;
  return judge_missing(flow, sent, flow.destination);
}

/// Corrects a wrong match: the receiver took this send, but that was credited to another one of the same content,
/// which need not have been delivered. @return false if there is no such send
bool ResultJudge::taken_for_other(Flow& flow, Sent& sent, std::uint8_t receiver) {
  return any_alike(flow, sent, receiver, kWhenever, [&](Sent& other) {
    const bool must = !other.by_node || other.by_node->passed[receiver];
    const bool sure = other.ended && other.outcome == Outcome::delivered && must;
    const std::uint16_t taken = other.taken_in(receiver);
    if (sure || taken != ring_.at(receiver).life) return false;
    std::swap(other.taken_in(receiver), sent.taken_in(receiver));
    return true;
  });
}

/// Corrects a wrong match the other way: this send was not taken, but another one of the same content was.
/// @return false if there is no such send
bool ResultJudge::other_was_meant(Flow& flow, Sent& sent, std::uint8_t receiver) {
  return any_alike(flow, sent, receiver, kWhenever, [&](Sent& other) {
    const bool untaken = other.taken_in(receiver) != ring_.at(receiver).life;
    if (!untaken || (other.ended && says_untaken(other.outcome) && !other.by_node)) return false;
    std::swap(other.taken_in(receiver), sent.taken_in(receiver));
    return true;
  });
}

bool ResultJudge::judge_taken(Flow& flow, Sent& sent) {
  if (!says_untaken(sent.outcome)) return true;
  if (ring_.round < sent.ended_round + 3) return false;  // another one of that content may have been meant
  if (other_was_meant(flow, sent, flow.destination)) return true;
  if (ring_.forgives(flow, flow.destination, sent.asked)) return report_.leave_unjudged(Unjudged::alike);
  report_.break_promise(Promise::true_result, flow.source, flow.source, sent.ended_at,
                        name_of(flow, sent) + " ended " + wire::to_string(sent.outcome) + ", and node " +
                            std::to_string(flow.destination) + " has taken it");
  return true;
}

bool ResultJudge::judge_missing(Flow& flow, Sent& sent, std::uint8_t receiver) {
  const SeenNode& to = ring_.at(receiver);
  const bool delivered = sent.outcome == Outcome::delivered;
  if (!to.known || to.known_round + 2 > sent.asked_round) return !delivered || report_.leave_unjudged(to.before);
  if (to.flushed_round + 2 >= sent.asked_round)
    return !delivered || report_.leave_unjudged(Unjudged::receiver_restarted);
  if (!delivered) return is_over_at(receiver, flow, sent);
  const std::uint32_t looked = flow.queue == Observation::kInterrupt ? to.seen_round : to.empty_round;
  if (looked < sent.ended_round + 2 || to.has_pending(flow)) return false;
  if (taken_for_other(flow, sent, receiver)) return true;
  if (ring_.forgives(flow, receiver, sent.asked)) return report_.leave_unjudged(Unjudged::alike);
  report_.break_promise(Promise::true_result, receiver, flow.source, sent.ended_at,
                        name_of(flow, sent) + " ended delivered, and " +
                            (flow.queue == Observation::kInterrupt ? "pulled no pin of" : "never came to the CPU of") +
                            " node " + std::to_string(receiver));
  return true;
}

// A node that is up and that the broadcast has passed must have taken or refused it.
bool ResultJudge::judge_broadcast(Flow& flow, Sent& sent) {
  if (sent.outcome != Outcome::delivered) return is_over_everywhere(flow, sent);
  if (ring_.round < sent.ended_round + 3) return false;
  // A packet that turns back at a fold passes nodes without being taken there.
  const auto whole = [&](std::uint8_t id) { return is_in_ring_since(id, sent); };
  const bool may_turn_back =
      fold_back_ && (sent.tries > 1 || !std::all_of(ring_.known.begin(), ring_.known.end(), whole));
  if (may_turn_back) return report_.leave_unjudged(Unjudged::ring_changed);
  for (const std::uint8_t id : ring_.known) {
    if (!sent.by_node->passed[id] || sent.by_node->taken_in[id] != 0) continue;
    if (!is_in_ring_since(id, sent) || !is_in_ring_since(flow.source, sent))
      return report_.leave_unjudged(Unjudged::ring_changed);
    if (!judge_missing(flow, sent, id)) return false;
    sent.by_node->passed.reset(id);  // told once
  }
  return true;
}

/// All that took it have given it to their CPUs by now.
bool ResultJudge::is_over_everywhere(const Flow& flow, const Sent& sent) const {
  return std::all_of(ring_.known.begin(), ring_.known.end(), [&](std::uint8_t id) {
    return id == flow.source || sent.by_node->taken_in[id] == ring_.at(id).life || is_over_at(id, flow, sent);
  });
}

bool ResultJudge::is_in_ring_since(std::uint8_t id, const Sent& sent) const {
  const SeenNode& node = ring_.at(id);
  return node.known && node.state == kUp && node.state_round + 2 <= sent.asked_round;
}

}  // namespace limb_ring::promises
