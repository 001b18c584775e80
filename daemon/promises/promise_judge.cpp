#include "promises/promise_judge.h"

#include <algorithm>
#include <numeric>

#include "wire/outcome.h"
#include "wire/packet.h"

namespace limb_ring::promises {

using Kind = Observation::Kind;
using wire::Outcome;

namespace {

/// A send that was not delivered may still be read by a CPU for so many rounds.
constexpr std::uint32_t kLate = 60;
/// Of one flow, at most so many are kept.
constexpr std::size_t kMost = 20000;
/// core::NodeState, as numbers: the two in which users may send into a closed ring, and the first one.
constexpr std::uint8_t kStarting = 0, kUp = 2;

bool is_delivered(std::uint8_t outcome) { return outcome == static_cast<std::uint8_t>(Outcome::delivered); }
bool is_rejected(std::uint8_t outcome) { return outcome == static_cast<std::uint8_t>(Outcome::rejected); }
/// Nobody has taken it.
bool says_untaken(std::uint8_t outcome) {
  return outcome == static_cast<std::uint8_t>(Outcome::refused) ||
         outcome == static_cast<std::uint8_t>(Outcome::no_such_node) || is_rejected(outcome);
}

std::string name_of(const Observation& packet, std::uint8_t source) {
  const bool interrupt = packet.queue == Observation::kInterrupt;
  const std::string to = packet.destination == wire::kBroadcast ? "all" : std::to_string(packet.destination);
  return (interrupt ? "INTP of node " : "DATP of node ") + std::to_string(source) + " to " + to +
         (interrupt ? ", factor " + std::to_string(packet.channel)
                    : ", priority " + std::to_string(packet.queue) + ", channel " + std::to_string(packet.channel) +
                          ", " + std::to_string(packet.size) + " bytes");
}

}  // namespace

const char* to_string(Unjudged why) {
  switch (why) {
    case Unjudged::receiver_unknown:
      return "the receiver was not seen";
    case Unjudged::receiver_restarted:
      return "the receiver or its CPU was restarted";
    case Unjudged::source_unknown:
      return "the source was not seen for long enough";
    case Unjudged::observations_lost:
      return "observations were lost";
    case Unjudged::ring_changed:
      return "broadcasts while the ring changed";
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

// ---- flows ----------------------------------------------------------------------------------

PromiseJudge::Flow* PromiseJudge::find_flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination) {
  auto& flows = nodes_[source].flows;
  return flows.empty() ? nullptr : flows[queue * kNodes + destination].get();
}

PromiseJudge::Flow& PromiseJudge::flow(std::uint8_t source, std::uint8_t queue, std::uint8_t destination) {
  auto& flows = nodes_[source].flows;
  if (flows.empty()) flows.resize(kQueues * kNodes);
  auto& found = flows[queue * kNodes + destination];
  if (!found) found = std::make_unique<Flow>(Flow{source, queue, destination, {}, 0, false});
  return *found;
}

std::uint64_t& PromiseJudge::newest(std::uint8_t receiver, std::uint8_t source, std::uint8_t queue) {
  auto& all = nodes_[receiver].newest;
  if (all.empty()) all.resize(kNodes * kQueues);
  return all[source * kQueues + queue];
}

std::uint16_t PromiseJudge::life_of(std::uint8_t receiver, std::uint8_t queue) const {
  return queue == Observation::kInterrupt ? nodes_[receiver].pins_life : nodes_[receiver].life;
}

std::uint16_t& PromiseJudge::taken_in(Sent& sent, std::uint8_t receiver) {
  return sent.by_node ? sent.by_node->taken_in[receiver] : sent.taken_in;
}

// ---- the nodes ------------------------------------------------------------------------------

void PromiseJudge::begins(std::uint8_t id, std::uint8_t state, std::chrono::nanoseconds longest_send,
                          std::int64_t at_ns) {
  Node& node = at(id);
  ends(id);  // a former life of which nobody has said so
  node.known = true;
  node.closing = false;
  known_.push_back(id);
  node.known_round = node.state_round = round_;
  node.known_at = node.at = at_ns;
  node.empty_round = node.flushed_round = 0;
  node.empty_at = 0;
  node.longest_send = longest_send.count();
  node.state = state;
  node.life = node.pins_life = static_cast<std::uint16_t>(std::max(node.life, node.pins_life) + 1);
  node.proven_at.fill(0);
  node.newest.clear();
  for (const Pending& pending : node.pending)
    if (pending.seen.kind != Kind::passed) leave(Unjudged::receiver_restarted);
  node.pending.clear();
}

void PromiseJudge::ends(std::uint8_t id) {
  Node& node = at(id);
  if (!node.known) return;
  leaves(id);
  for (auto& flow : node.flows)
    if (flow)
      for (Sent& sent : flow->sends)
        if (!sent.ended) {
          sent.ended = sent.cut_short = true;
          sent.outcome = static_cast<std::uint8_t>(Outcome::cancelled);
          sent.ended_round = round_;
          sent.ended_at = node.at;
        }
}

void PromiseJudge::leaves(std::uint8_t id) {
  Node& node = at(id);
  node.known = false;
  known_.erase(std::remove(known_.begin(), known_.end(), id), known_.end());
  node.proven_at.fill(0);
}

void PromiseJudge::lost(std::uint8_t id, std::uint64_t count) {
  Node& node = at(id);
  counts_.lost += count;
  forget_sends(node, Unjudged::observations_lost);
  begins(id, node.state, std::chrono::nanoseconds(node.longest_send), node.at);
}

void PromiseJudge::forget_sends(Node& node, Unjudged why) {
  for (auto& flow : node.flows) {
    if (!flow) continue;
    for (const Sent& sent : flow->sends)
      if (!sent.judged) leave(why);
    flow->sends.clear();
    flow->first_open = 0;
  }
}

void PromiseJudge::see(std::uint8_t id, const Observation& seen) {
  Node& node = at(id);
  if (!node.known) return;
  node.alive += std::clamp<std::int64_t>(seen.at_ns - node.at, 0, times_.step.count());
  node.at = seen.at_ns;
  node.seen_round = round_;
  switch (seen.kind) {
    case Kind::asked:
      return asked(id, seen);
    case Kind::ended:
      return ended(id, seen);
    case Kind::taken:
    case Kind::pin:
      return taken(id, seen);
    case Kind::passed:
      return passed(id, seen);
    case Kind::circles:
      return break_promise(Promise::no_circling, id, seen.source, seen.at_ns,
                           "a packet of node " + std::to_string(seen.source) + " with HOP " +
                               std::to_string(seen.size) + " came into node " + std::to_string(id) +
                               ": it has gone round");
    case Kind::flushed:
      node.flushed_round = round_;
      return;
    case Kind::state:
      return state(id, seen.detail);
    case Kind::goes_on:
      if (seen.detail == 0) return;
      node.empty_round = round_;
      node.empty_at = seen.at_ns;
      return;
  }
}

// What it had decided of INTPs before it started over it may decide once more.
void PromiseJudge::state(std::uint8_t id, std::uint8_t after) {
  Node& node = at(id);
  node.state = after;
  node.state_round = round_;
  if (after == kStarting) node.pins_life = static_cast<std::uint16_t>(std::max(node.life, node.pins_life) + 1);
}

// ---- sources --------------------------------------------------------------------------------

void PromiseJudge::asked(std::uint8_t id, const Observation& seen) {
  ++counts_.sends;
  Node& node = at(id);
  Flow& to = flow(id, seen.queue, seen.destination);
  if (to.sends.size() >= kMost) {
    if (!to.sends.front().judged) leave(Unjudged::too_many);
    to.sends.pop_front();
    if (to.first_open != 0) --to.first_open;
    node.known_at = seen.at_ns;  // its end is not known any more
    node.proven_at.fill(0);
  }
  Sent& sent = to.sends.emplace_back();
  sent.asked = seen;
  sent.index = ++node.asked[seen.queue];
  sent.asked_round = round_;
  sent.asked_alive = node.alive;
  if (seen.destination == wire::kBroadcast) sent.by_node = std::make_unique<ByNode>();
  if (to.listed) return;
  to.listed = true;
  active_.push_back(&to);
}

PromiseJudge::Sent* PromiseJudge::find_open(std::uint8_t id, const Observation& seen) {
  const bool interrupt = seen.queue == Observation::kInterrupt;
  for (std::uint8_t queue = interrupt ? Observation::kInterrupt : 0; queue < (interrupt ? kQueues : 4); ++queue) {
    Flow* to = find_flow(id, queue, seen.destination);
    if (to == nullptr) continue;
    while (to->first_open < to->sends.size() && to->sends[to->first_open].ended) ++to->first_open;
    for (std::size_t i = to->first_open; i < to->sends.size(); ++i) {
      Sent& sent = to->sends[i];
      if (!sent.ended && sent.asked.token == seen.token && sent.asked.owner == seen.owner) return &sent;
    }
  }
  return nullptr;
}

void PromiseJudge::ended(std::uint8_t id, const Observation& seen) {
  Sent* sent = find_open(id, seen);
  if (sent == nullptr) return ended_again(id, seen);
  sent->ended = true;
  sent->ended_round = round_;
  sent->ended_at = seen.at_ns;
  sent->outcome = seen.detail;
  sent->tries = seen.tries;
  const bool was_out = seen.tries != 0 && seen.detail != static_cast<std::uint8_t>(Outcome::cancelled);
  std::int64_t& proven = at(id).proven_at[sent->asked.queue];
  // Sends of a queue go in order: all that were asked for before anybody looked have ended.
  if (was_out && proven == 0) proven = seen.at_ns;
}

void PromiseJudge::ended_again(std::uint8_t id, const Observation& seen) {
  const Node& node = at(id);
  const bool interrupt = seen.queue == Observation::kInterrupt;
  for (std::uint8_t queue = interrupt ? Observation::kInterrupt : 0; queue < (interrupt ? kQueues : 4); ++queue) {
    Flow* to = find_flow(id, queue, seen.destination);
    if (to == nullptr) continue;
    for (const Sent& sent : to->sends)
      if (!sent.cut_short && sent.asked.token == seen.token && sent.asked.owner == seen.owner)
        return break_promise(Promise::one_result, id, id, seen.at_ns, name(*to, sent) + " has two results");
  }
  if (seen.at_ns - node.known_at < node.longest_send + times_.copies_last.count())
    return void(leave(Unjudged::source_unknown));
  break_promise(Promise::one_result, id, id, seen.at_ns,
                "a send of node " + std::to_string(id) + " to " + std::to_string(seen.destination) +
                    " ended, and nobody had asked for it, or it had ended long before");
}

// ---- receivers ------------------------------------------------------------------------------

void PromiseJudge::taken(std::uint8_t id, const Observation& seen) {
  ++counts_.packets;
  Node& node = at(id);
  if (seen.destination != id && seen.destination != wire::kBroadcast)
    return break_promise(Promise::undamaged, id, seen.source, seen.at_ns,
                         name_of(seen, seen.source) + ", was given to the CPU of node " + std::to_string(id));
  // Behind one that waits for its cause others wait as well: their order is judged.
  if (!node.pending.empty() || !match(id, seen)) node.pending.push_back({seen, round_, node.empty_at});
}

/// The first send of that content behind what this receiver took last. INTPs of one factor are all alike, so their
/// order cannot be told; a pin is pulled at once, so rather one that has not ended.
PromiseJudge::Sent* PromiseJudge::next_in_order(std::uint8_t receiver, Flow* flow, const Observation& seen) {
  if (flow == nullptr) return nullptr;
  const std::uint64_t last = seen.kind == Kind::pin ? 0 : newest(receiver, seen.source, seen.queue);
  Sent* old = nullptr;
  auto it = std::upper_bound(flow->sends.begin(), flow->sends.end(), last,
                             [](std::uint64_t index, const Sent& sent) { return index < sent.index; });
  for (; it != flow->sends.end(); ++it) {
    const bool before_its_life = it->ended_round <= nodes_[receiver].known_round;
    if (it->ended && (is_rejected(it->outcome) || before_its_life)) continue;
    const std::uint16_t taken = taken_in(*it, receiver);
    const bool again = taken != 0 && (it->ended || taken == life_of(receiver, seen.queue));
    if (again || !it->asked.same_content(seen)) continue;
    if (seen.kind != Kind::pin || !it->ended || it->ended_round + 2 >= round_) return &*it;
    if (old == nullptr) old = &*it;
  }
  return old;
}

// A pin does not tell whether the INTP was to all.
bool PromiseJudge::match(std::uint8_t receiver, const Observation& seen) {
  Sent* sent = next_in_order(receiver, find_flow(seen.source, seen.queue, seen.destination), seen);
  if (seen.kind == Kind::pin && seen.source != receiver) {
    Sent* to_all = next_in_order(receiver, find_flow(seen.source, seen.queue, wire::kBroadcast), seen);
    const auto is_open = [](const Sent& one) { return !one.ended; };
    const bool rather = to_all != nullptr && sent != nullptr &&
                        (is_open(*to_all) != is_open(*sent) ? is_open(*to_all) : to_all->index < sent->index);
    if (sent == nullptr || rather) sent = to_all;
  }
  if (sent == nullptr) return false;
  taken_in(*sent, receiver) = life_of(receiver, seen.queue);
  sent->taken_at = seen.at_ns;
  newest(receiver, seen.source, seen.queue) = sent->index;
  return true;
}

void PromiseJudge::settle_pending(std::uint8_t receiver) {
  auto& pending = at(receiver).pending;
  std::bitset<kNodes * kQueues> waits;  // by source and queue: one of these does
  for (std::size_t left = pending.size(); left != 0; --left) {
    const Pending next = pending.front();
    pending.pop_front();
    const std::size_t from = next.seen.source * kQueues + next.seen.queue;
    const bool pass = next.seen.kind == Kind::passed;
    if (!waits[from] && (pass ? mark_passed(receiver, next.seen) : match(receiver, next.seen))) continue;
    if (next.round == round_) {
      waits[from] = waits[from] || !pass;
      pending.push_back(next);
    } else if (!pass) {
      classify(receiver, next);
    }
  }
}

/// No send can be under way that was not seen.
bool PromiseJudge::certain(std::uint8_t receiver, const Pending& pending) const {
  const Node& from = nodes_[pending.seen.source];
  const Node& to = nodes_[receiver];
  if (!from.known || from.closing || !to.known) return false;
  const std::int64_t proven = from.proven_at[pending.seen.queue];
  const std::int64_t at_last = from.known_at + from.longest_send;
  const std::int64_t all_seen = proven == 0 ? at_last : std::min(proven, at_last);
  const std::int64_t came_after = pending.seen.kind == Kind::pin ? pending.seen.at_ns : pending.empty_at;
  return came_after >= std::max(all_seen, to.known_at) + times_.copies_last.count();
}

void PromiseJudge::classify(std::uint8_t receiver, const Pending& pending) {
  const Observation& seen = pending.seen;
  if (!certain(receiver, pending)) return void(leave(Unjudged::source_unknown));
  const std::string by = " node " + std::to_string(receiver);
  const bool pin = seen.kind == Kind::pin;
  for (const std::uint8_t destination : {seen.destination, std::uint8_t{wire::kBroadcast}}) {
    Flow* from = destination == seen.destination || pin ? find_flow(seen.source, seen.queue, destination) : nullptr;
    if (from == nullptr) continue;
    for (auto it = from->sends.rbegin(); it != from->sends.rend(); ++it) {
      if (!it->asked.same_content(seen) || (it->ended && is_rejected(it->outcome))) continue;
      const std::uint16_t taken = taken_in(*it, receiver);
      const bool before = taken == life_of(receiver, seen.queue);
      taken_in(*it, receiver) = life_of(receiver, seen.queue);
      if (taken != 0 && !before) return;  // a late copy, in another life of the receiver
      if (before && pin)
        return break_promise(Promise::exactly_once, receiver, seen.source, seen.at_ns,
                             name(*from, *it) + ", has pulled its pin twice at" + by);
      if (before)
        return break_promise(Promise::exactly_once, receiver, seen.source, seen.at_ns,
                             name(*from, *it) + ", was taken twice by" + by);
      return break_promise(Promise::in_order, receiver, seen.source, seen.at_ns,
                           name(*from, *it) + ", was taken by" + by + " after one that was asked for later");
    }
  }
  break_promise(Promise::undamaged, receiver, seen.source, seen.at_ns,
                name_of(seen, seen.source) + ", " + (pin ? "has pulled a pin of" : "was taken by") + by +
                    ", and was not asked for");
}

void PromiseJudge::passed(std::uint8_t id, const Observation& seen) { at(id).pending.push_back({seen, round_, 0}); }

bool PromiseJudge::mark_passed(std::uint8_t id, const Observation& seen) {
  Flow* from = find_flow(seen.source, seen.queue, wire::kBroadcast);
  if (from == nullptr) return false;
  for (Sent& sent : from->sends) {
    if (sent.by_node->passed[id] || !sent.asked.same_content(seen)) continue;
    sent.by_node->passed.set(id);
    return true;
  }
  return false;
}

// ---- judging --------------------------------------------------------------------------------

void PromiseJudge::round_is_over() {
  for (const std::uint8_t id : known_) settle_pending(id);
  for (Flow* flow : active_) settle(*flow);
  const auto is_idle = [](Flow* flow) {
    if (!flow->sends.empty()) return false;
    flow->listed = false;
    return true;
  };
  active_.erase(std::remove_if(active_.begin(), active_.end(), is_idle), active_.end());
  ++round_;
}

void PromiseJudge::settle(Flow& flow) {
  for (Sent& sent : flow.sends) {
    if (sent.judged || !judge(flow, sent)) continue;
    sent.judged = true;
    ++counts_.judged;
  }
  while (!flow.sends.empty() && is_done_with(flow, flow.sends.front())) {
    flow.sends.pop_front();
    if (flow.first_open != 0) --flow.first_open;
  }
}

/// It can come to nobody any more, and a second copy would have come.
bool PromiseJudge::is_done_with(const Flow& flow, const Sent& sent) const {
  const Node& source = nodes_[flow.source];
  if (!sent.judged || !sent.ended) return false;
  if (source.known && std::max(sent.ended_at, sent.taken_at) + times_.kept.count() >= source.at) return false;
  return sent.by_node ? is_over_everywhere(flow, sent) : sent.taken_in != 0 || is_over_at(flow.destination, flow, sent);
}

bool PromiseJudge::is_over_at(std::uint8_t receiver, const Flow& flow, const Sent& sent) const {
  const Node& node = nodes_[receiver];
  if (!node.known || node.known_round > sent.ended_round) return true;
  return (flow.queue == Observation::kInterrupt ? node.seen_round : node.empty_round) >= sent.ended_round + kLate;
}

/// @return false where that is not known yet
bool PromiseJudge::judge(Flow& flow, Sent& sent) {
  if (!sent.ended) return judge_open(flow, sent);
  return sent.by_node ? judge_broadcast(flow, sent) : judge_unicast(flow, sent);
}

bool PromiseJudge::judge_open(Flow& flow, Sent& sent) {
  const Node& source = at(flow.source);
  if (source.alive - sent.asked_alive < source.longest_send + times_.copies_last.count()) return false;
  sent.ended = sent.cut_short = true;
  sent.outcome = static_cast<std::uint8_t>(Outcome::cancelled);
  sent.ended_at = source.at;
  break_promise(Promise::one_result, flow.source, flow.source, source.at, name(flow, sent) + " has not ended");
  return true;
}

bool PromiseJudge::judge_unicast(Flow& flow, Sent& sent) {
  if (sent.taken_in == life_of(flow.destination, flow.queue)) return judge_taken(flow, sent);
  if (sent.taken_in != 0) return true;
  return judge_missing(flow, sent, flow.destination);
}

bool PromiseJudge::judge_taken(Flow& flow, Sent& sent) {
  if (!says_untaken(sent.outcome)) return true;
  if (round_ < sent.ended_round + 3) return false;  // another one of that content may have been meant
  if (other_was_meant(flow, sent, flow.destination)) return true;
  break_promise(Promise::true_result, flow.source, flow.source, sent.ended_at,
                name(flow, sent) + " ended " + wire::to_string(static_cast<Outcome>(sent.outcome)) + ", and node " +
                    std::to_string(flow.destination) + " has taken it");
  return true;
}

/// Something of that flow was taken, and it is not known yet which send it was.
bool PromiseJudge::has_pending(const Node& receiver, const Flow& flow) const {
  return std::any_of(receiver.pending.begin(), receiver.pending.end(), [&](const Pending& pending) {
    const Observation& seen = pending.seen;
    return seen.kind != Kind::passed && seen.source == flow.source && seen.queue == flow.queue;
  });
}

bool PromiseJudge::judge_missing(Flow& flow, Sent& sent, std::uint8_t receiver) {
  const Node& to = at(receiver);
  const bool delivered = is_delivered(sent.outcome);
  if (!to.known || to.known_round + 2 > sent.asked_round)
    return !delivered || leave(to.known ? Unjudged::receiver_restarted : Unjudged::receiver_unknown);
  if (to.flushed_round + 2 >= sent.asked_round) return !delivered || leave(Unjudged::receiver_restarted);
  if (!delivered) return is_over_at(receiver, flow, sent);
  const std::uint32_t looked = flow.queue == Observation::kInterrupt ? to.seen_round : to.empty_round;
  if (looked < sent.ended_round + 2 || has_pending(to, flow)) return false;
  if (taken_for_other(flow, sent, receiver)) return true;
  break_promise(Promise::true_result, receiver, flow.source, sent.ended_at,
                name(flow, sent) + " ended delivered, and " +
                    (flow.queue == Observation::kInterrupt ? "pulled no pin of" : "never came to the CPU of") +
                    " node " + std::to_string(receiver));
  return true;
}

// A node that is up and through which it has passed must have taken it, or refused.
bool PromiseJudge::judge_broadcast(Flow& flow, Sent& sent) {
  if (!is_delivered(sent.outcome)) return is_over_everywhere(flow, sent);
  if (round_ < sent.ended_round + 3) return false;
  // What turns back somewhere passes nodes that do not take it.
  const auto whole = [&](std::uint8_t id) { return is_in_ring_since(id, sent); };
  const bool may_turn_back = fold_back_ && (sent.tries > 1 || !std::all_of(known_.begin(), known_.end(), whole));
  if (may_turn_back) return leave(Unjudged::ring_changed);
  for (const std::uint8_t id : known_) {
    if (!sent.by_node->passed[id] || sent.by_node->taken_in[id] != 0) continue;
    if (!is_in_ring_since(id, sent) || !is_in_ring_since(flow.source, sent)) return leave(Unjudged::ring_changed);
    if (!judge_missing(flow, sent, id)) return false;
    sent.by_node->passed.reset(id);  // told once
  }
  return true;
}

/// All that took it have given it to their CPUs by now.
bool PromiseJudge::is_over_everywhere(const Flow& flow, const Sent& sent) const {
  return std::all_of(known_.begin(), known_.end(), [&](std::uint8_t id) {
    return id == flow.source || sent.by_node->taken_in[id] == life_of(id, flow.queue) || is_over_at(id, flow, sent);
  });
}

bool PromiseJudge::is_in_ring_since(std::uint8_t id, const Sent& sent) const {
  const Node& node = nodes_[id];
  return node.known && node.state == kUp && node.state_round + 2 <= sent.asked_round;
}

/// Sends that cannot be told from that one at the receiver: a pin does not tell whether the INTP was to all.
/// @param visit returns true where it wants no more of them
template <class Visit>
bool PromiseJudge::any_alike(const Flow& flow, const Sent& sent, std::uint8_t receiver, Visit visit) {
  const std::uint8_t other_way = flow.destination == wire::kBroadcast ? receiver : std::uint8_t{wire::kBroadcast};
  for (const std::uint8_t destination : {flow.destination, other_way}) {
    const bool told_apart = flow.queue != Observation::kInterrupt && destination != flow.destination;
    Flow* others = told_apart ? nullptr : find_flow(flow.source, flow.queue, destination);
    if (others == nullptr) continue;
    for (Sent& other : others->sends)
      if (&other != &sent && other.asked.same_content(sent.asked) && visit(other)) return true;
  }
  return false;
}

/// What the receiver took was taken for another send of that content, which was not delivered.
bool PromiseJudge::taken_for_other(Flow& flow, Sent& sent, std::uint8_t receiver) {
  return any_alike(flow, sent, receiver, [&](Sent& other) {
    const bool must = !other.by_node || other.by_node->passed[receiver];
    const bool sure = other.ended && is_delivered(other.outcome) && must;
    if (sure || taken_in(other, receiver) != life_of(receiver, flow.queue)) return false;
    std::swap(taken_in(other, receiver), taken_in(sent, receiver));
    return true;
  });
}

/// It was not taken: another send of that content was, which had not been found so.
bool PromiseJudge::other_was_meant(Flow& flow, Sent& sent, std::uint8_t receiver) {
  return any_alike(flow, sent, receiver, [&](Sent& other) {
    const bool untaken = taken_in(other, receiver) != life_of(receiver, flow.queue);
    if (!untaken || (other.ended && says_untaken(other.outcome) && !other.by_node)) return false;
    std::swap(taken_in(other, receiver), taken_in(sent, receiver));
    return true;
  });
}

// ---- telling --------------------------------------------------------------------------------

std::string PromiseJudge::name(const Flow& flow, const Sent& sent) const {
  return name_of(sent.asked, flow.source) + ", token " + std::to_string(sent.asked.token);
}

void PromiseJudge::break_promise(Promise promise, std::uint8_t node, std::uint8_t source, std::int64_t at,
                                 std::string what) {
  ++counts_.breaches;
  const auto [told, first] = told_.try_emplace({promise, node, source}, at);
  if (!first && at - told->second < times_.told_again.count()) return;
  told->second = at;
  on_breach_({promise, node, source, at, std::move(what)});
}

}  // namespace limb_ring::promises
