#include "judge/result_judge.h"

#include <algorithm>

#include "wire/packet.h"

namespace limb_ring::promises {

using wire::Outcome;

namespace {

/// For so many rounds after its end, a CPU may still read a send that was not delivered.
constexpr Round kLate = 60;
/// core::NodeState::up, in which users may send into a closed ring.
constexpr std::uint8_t kUp = 2;

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
  while (!flow.sends.empty() && is_done_with(flow, flow.sends.front())) forget_first(flow);
}

/// What its receivers may have taken or not is remembered while others with its data are there.
void ResultJudge::forget_first(Flow& flow) {
  Sent& sent = flow.sends.front();
  if (!sent.by_node) note_former(flow, sent, flow.destination);
  for (const std::uint8_t receiver : ring_.known)
    if (sent.by_node && receiver != flow.source) note_former(flow, sent, receiver);
  flow.pop_front();
}

void ResultJudge::note_former(const Flow& flow, Sent& sent, std::uint8_t receiver) {
  SeenNode& node = ring_.at(receiver);
  const auto key = SeenRing::key(flow, sent.asked);
  if (!ring_.any_alike(flow, receiver, sent.asked, [&](const Sent& other) { return &other != &sent; }))
    return void(node.former.erase(key));
  const bool taken = sent.taken_in(receiver) == node.life;
  if (must_come(flow, sent, receiver) || (sent.is_untaken() && !taken)) return;
  Former& former = node.former[key];
  ++(taken ? former.taken : former.untaken);
}

/// Nobody can receive it any more, and a second copy would have been seen by now.
bool ResultJudge::is_done_with(const Flow& flow, const Sent& sent) const {
  const SeenNode& source = ring_.at(flow.source);
  if (!sent.judged || !sent.ended) return false;
  if (source.known && std::max(sent.ended_at, sent.taken_at) + times_.kept.count() >= source.at) return false;
  return sent.by_node ? is_over_everywhere(flow, sent)
                      : sent.taken_life != 0 || is_over_at(flow.destination, flow, sent);
}

bool ResultJudge::is_over_at(std::uint8_t receiver, const Flow& flow, const Sent& sent) const {
  const SeenNode& node = ring_.at(receiver);
  if (!node.known || node.known_round > sent.ended_round) return true;
  return (flow.queue == Observation::kInterrupt ? node.seen_round : node.empty_round) >= sent.ended_round + kLate;
}

/// @return false if that is not known yet
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

/// It ended delivered and has passed the receiver, which gave it to its CPU, or broke a promise.
bool ResultJudge::must_come(const Flow& flow, const Sent& sent, std::uint8_t receiver) const {
  const bool passed = !sent.by_node || sent.by_node->passed[receiver];
  return sent.ended && sent.outcome == Outcome::delivered && passed && !excuse(flow, sent, receiver);
}

/// Corrects a wrong match: the receiver took this send, but that was credited to another one of the same content,
/// which need not have come. @return false if there is no such send
bool ResultJudge::taken_for_other(Flow& flow, Sent& sent, std::uint8_t receiver) {
  return ring_.any_alike(flow, receiver, sent.asked, [&](Sent& other) {
    if (&other == &sent || other.taken_in(receiver) != ring_.at(receiver).life) return false;
    if (must_come(flow, other, receiver)) return false;
    std::swap(other.taken_in(receiver), sent.taken_in(receiver));
    return true;
  });
}

/// Corrects a wrong match the other way: this send was not taken, but another one of the same content was.
/// @return false if there is no such send
bool ResultJudge::other_was_meant(Flow& flow, Sent& sent, std::uint8_t receiver) {
  return ring_.any_alike(flow, receiver, sent.asked, [&](Sent& other) {
    if (other.taken_in(receiver) == ring_.at(receiver).life || other.is_untaken()) return false;
    std::swap(other.taken_in(receiver), sent.taken_in(receiver));
    return true;
  });
}

bool ResultJudge::judge_taken(Flow& flow, Sent& sent) {
  if (!sent.is_untaken()) return true;
  if (ring_.round < sent.ended_round + 3) return false;  // another one of that content may have been meant
  const std::uint8_t receiver = flow.destination;
  if (other_was_meant(flow, sent, receiver)) return true;
  if (ring_.stands_for_former(flow, receiver, sent.asked)) {
    sent.taken_life = 0;
    return report_.leave_unjudged(Unjudged::alike);
  }
  report_.break_promise(Promise::true_result, flow.source, flow.source, sent.ended_at,
                        name_of(flow, sent) + " ended " + wire::to_string(sent.outcome) + ", and node " +
                            std::to_string(receiver) + " has taken it");
  return true;
}

/// Why it is not a breach that the receiver has not given that send to its CPU, though it ended delivered.
std::optional<Unjudged> ResultJudge::excuse(const Flow& flow, const Sent& sent, std::uint8_t receiver) const {
  const SeenNode& to = ring_.at(receiver);
  if (sent.by_node &&
      (may_turn_back(sent) || !is_in_ring_since(receiver, sent) || !is_in_ring_since(flow.source, sent)))
    return Unjudged::ring_changed;
  if (!to.known || to.known_round + 2 > sent.asked_round) return to.before;
  if (to.flushed_round + 2 >= sent.asked_round) return Unjudged::receiver_restarted;
  return std::nullopt;
}

bool ResultJudge::judge_missing(Flow& flow, Sent& sent, std::uint8_t receiver) {
  const SeenNode& to = ring_.at(receiver);
  const bool delivered = sent.outcome == Outcome::delivered;
  if (const auto why = excuse(flow, sent, receiver)) return !delivered || report_.leave_unjudged(*why);
  if (!delivered) return is_over_at(receiver, flow, sent);
  const std::uint32_t looked = flow.queue == Observation::kInterrupt ? to.seen_round : to.empty_round;
  if (looked < sent.ended_round + 2 || to.has_pending(flow)) return false;
  if (taken_for_other(flow, sent, receiver)) return true;
  if (ring_.former_stands_for(flow, receiver, sent.asked)) return report_.leave_unjudged(Unjudged::alike);
  report_.break_promise(Promise::true_result, receiver, flow.source, sent.ended_at,
                        name_of(flow, sent) + " ended delivered, and " +
                            (flow.queue == Observation::kInterrupt ? "pulled no pin of" : "never came to the CPU of") +
                            " node " + std::to_string(receiver));
  sent.taken_in(receiver) = to.life;  // else the next one of its content would be found to be this one
  return true;
}

/// A packet that turns back at a fold passes nodes without being taken there.
bool ResultJudge::may_turn_back(const Sent& sent) const {
  const auto whole = [&](std::uint8_t id) { return is_in_ring_since(id, sent); };
  return fold_back_ && (sent.tries > 1 || !std::all_of(ring_.known.begin(), ring_.known.end(), whole));
}

// A node that is up and that the broadcast has passed must have taken or refused it.
bool ResultJudge::judge_broadcast(Flow& flow, Sent& sent) {
  if (sent.outcome != Outcome::delivered) return is_over_everywhere(flow, sent);
  if (ring_.round < sent.ended_round + 3) return false;
  if (may_turn_back(sent)) return report_.leave_unjudged(Unjudged::ring_changed);
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
