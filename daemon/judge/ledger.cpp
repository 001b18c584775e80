#include "judge/ledger.h"

#include <algorithm>

namespace limb_ring::sim {

using core::Outcome;

Words Sent::name() const {
  return std::string(interrupt() ? "INTP " : "DATP ") + std::to_string(token) + " of " + node_words(source) + " to " +
         (destination == wire::kBroadcast ? "all" : node_words(destination)) +
         (interrupt() ? ", factor " + std::to_string(channel)
                      : ", priority " + std::to_string(queue) + ", " + std::to_string(size) + " bytes");
}

bool Sent::taken() const {
  return std::any_of(decisions.begin(), decisions.end(), [](const Decision& d) { return d.taken; });
}

bool Sent::decided_by(NodeId node) const {
  const auto from = decisions.begin() + static_cast<std::ptrdiff_t>(decided_from);
  return std::any_of(from, decisions.end(), [node](const Decision& d) { return d.node == node; });
}

bool Sent::is(const core::ReceivedPacket& packet) const {
  return packet.source == source && packet.destination == destination && packet.priority == queue &&
         packet.channel == channel && packet.size == size && wire::crc32(packet.bytes()) == checksum;
}

Ledger::Ledger(unsigned nodes, bool fold_back, Complain complain)
    : complain_(std::move(complain)),
      fold_back_(fold_back),
      sources_(nodes),
      forgotten_before_(nodes),
      started_(nodes),
      passed_over_(*this, complain_),
      newest_(std::size_t{nodes} * nodes * 5) {}

// ---- asked ----------------------------------------------------------------------------------

Sent* Ledger::find(NodeId source, std::uint32_t token) {
  Source& s = sources_[source];
  const std::uint32_t place = token - s.first_token;
  return token != 0 && token >= s.first_token && place < s.sent.size() ? &s.sent[place] : nullptr;
}

Sent& Ledger::add(NodeId source, std::uint32_t token, std::uint8_t queue, bool in_ring, Time now) {
  Source& s = sources_[source];
  forget_settled(s);
  if (s.sent.empty()) s.first_token = token;
  s.sent.emplace_back();
  Sent& sent = s.sent.back();
  sent.token = token;
  sent.source = source;
  sent.source_incarnation = s.incarnation;
  sent.asked = now;
  sent.asked_in_ring = in_ring;
  sent.queue = queue;
  sent.queue_shared = s.others_send;
  for (const std::uint32_t other : s.waiting[queue]) {
    const Sent* waits = find(source, other);
    if (waits && (!waits->ended || waits->ended_at >= now)) ++sent.ahead;
  }
  const Outstanding& outstanding =
      s.outstanding[queue == 4 ? 1 : 0];  // what was cancelled while out still has its place
  if (const Sent* out = find(source, outstanding.token); out && out->ended && outstanding.awaited) ++sent.ahead;
  s.waiting[queue].push_back(token);
  return sent;
}

void Ledger::ask(NodeId source, const core::SendRequest& request, bool in_ring, Time now) {
  Sent& sent = add(source, request.token, request.priority & 3, in_ring, now);
  sent.destination = request.destination;
  sent.channel = request.channel;
  sent.size = static_cast<std::uint16_t>(request.data.size);
  sent.checksum = wire::crc32(request.data);
}

void Ledger::ask(NodeId source, const core::InterruptRequest& request, bool in_ring, Time now) {
  Sent& sent = add(source, request.token, 4, in_ring, now);
  sent.destination = request.destination;
  sent.channel = request.factor;
}

// Drops sends that are not needed any more: no copy is under way, and the CPUs of the receivers have read them.
void Ledger::forget_settled(Source& s) {
  const auto settled = [](const Sent& sent) {
    const Outcome outcome = sent.end.outcome;
    const bool sure = outcome == Outcome::delivered || outcome == Outcome::refused ||
                      outcome == Outcome::no_such_node || outcome == Outcome::rejected;
    return sent.ended && sure && sent.end.tries <= 1 && sent.unread == 0;
  };
  while (s.sent.size() > 16 && settled(s.sent.front())) {
    s.sent.pop_front();
    ++s.first_token;
  }
}

// ---- on the line ----------------------------------------------------------------------------

/// Its sequence number now belongs to a new packet.
void Ledger::Slot::begin(std::uint32_t token) {
  constexpr std::size_t kMostFormer = 32;
  if (last.token != 0) former.push_back(last);
  if (former.size() > kMostFormer) former.erase(former.begin());
  last = {token, {}};
  begun = true;
}

void Ledger::waits_for_nothing(NodeId source) {
  for (Outstanding& outstanding : sources_[source].outstanding) {
    const unsigned before = outstanding.unknown();
    outstanding = {};
    outstanding.before = before;
  }
}

Ledger::Slot& Ledger::on_line_slot(NodeId source, wire::Code code, NodeId destination) {
  return sources_[source].on_line[(code.interrupt ? 2048u : 0u) + destination * 8u + code.sequence];
}

void Ledger::try_begins(NodeId source, wire::Code code, Time now) {
  Outstanding& outstanding = sources_[source].outstanding[code.interrupt ? 1 : 0];
  const int packet = wire::Code{code.interrupt, 0, code.sequence, code.incarnation}.byte();
  // If a fold took a first try off the line, its retry may have the number of the send before, which has ended.
  const Sent* out = find(source, outstanding.token);
  const bool has_ended = out && out->ended && out->ended_at < now;
  if (code.attempt == 0 || outstanding.packet != packet || has_ended) {
    outstanding = {packet, code.attempt, 0, 0, now, 0, outstanding.unknown(), true, false};
  }
  outstanding.tries = std::max(outstanding.tries, code.attempt + 0u) + 1;
  outstanding.since = now;
  outstanding.attempt = code.attempt;
  outstanding.damaged = false;
  outstanding.awaited = true;
  if (Sent* sent = find(source, outstanding.token)) count_tries(*sent, code);
}

void Ledger::count_tries(Sent& sent, wire::Code code) {
  Outstanding& outstanding = sources_[sent.source].outstanding[code.interrupt ? 1 : 0];
  outstanding.token = sent.token;
  sent.tries += outstanding.tries - outstanding.counted;
  outstanding.counted = outstanding.tries;
  sent.repeated = sent.repeated || code.attempt > 0;
  sent.attempts = code.attempt + 1u;
  sent.may_have_failed = false;
  sent.last_try = outstanding.since;
  if (sent.ended && sent.end.outcome != Outcome::cancelled) outstanding.awaited = false;  // unconfirmed
  sent.home_at = core::kNever;
}

// Times are compared strictly: a send that is asked for in the instant in which the line is given away may come too
// late, and one that ends in that instant is told of later.
void Ledger::note_passed_over(const Sent& leaving, Time since) {
  const auto waited = [&](const Sent* sent) {
    return sent && !sent->ended && !sent->final && sent->asked < since && since < sent->cancelled_at;
  };
  Source& source = sources_[leaving.source];
  for (const std::uint32_t token : source.waiting[leaving.queue]) {
    if (token == leaving.token) break;
    const Sent* sent = find(leaving.source, token);
    const bool refused = sent && sent->left && sent->refused_at <= since;
    if (waited(sent) && (!sent->left || refused)) passed_over_.note(*sent, leaving, since);
  }
  // Others may have a refused send at the head of a higher queue, which holds up ours.
  if (leaving.interrupt() || source.others_send) return;
  for (std::uint8_t higher = 0; higher < leaving.queue; ++higher) {
    const auto& waiting = source.waiting[higher];
    const auto first = std::find_if(waiting.begin(), waiting.end(), [&](std::uint32_t token) {
      const Sent* sent = find(leaving.source, token);
      return sent && !(sent->ended && sent->ended_at <= since) && !(sent->final && sent->home_at <= since);
    });
    if (first == waiting.end()) continue;
    const Sent* sent = find(leaving.source, *first);
    if (waited(sent) && !sent->left) passed_over_.note(*sent, leaving, since);
  }
}

// A retry belongs to the send that had its sequence number before, unless no try of that was seen. A first
// try belongs to the first send that waits and matches. (A send that is cancelled may end while it leaves, an
// unconfirmed one ends as it leaves.)
Sent* Ledger::depart(NodeId source, wire::Code code, const LeavingPacket& packet, Time since) {
  Slot& slot = on_line_slot(source, code, packet.destination);
  const auto over = [&](const Sent* sent) {
    if (!sent || sent->final) return true;
    return sent->ended &&
           (sent->ended_at < since || (sent->ended_at == since && sent->end.outcome != Outcome::unconfirmed));
  };
  Sent* before = find(source, slot.last.token);
  const bool same_incarnation = before && before->source_incarnation == sources_[source].incarnation;
  if (code.attempt > 0 && same_incarnation && !over(before) && packet.matches(*before)) {
    slot.last.crcs[code.attempt] = packet.crc;
    before->refused_at = core::kNever;  // what came home refused was a second copy, and did not count
    if (sources_[source].outstanding[code.interrupt ? 1 : 0].token != before->token) count_tries(*before, code);
    return before;
  }
  auto& waiting = sources_[source].waiting[packet.queue];
  while (!waiting.empty() && over(find(source, waiting.front()))) waiting.pop_front();
  for (const std::uint32_t token : waiting) {
    Sent* sent = find(source, token);
    if (over(sent) || !packet.matches(*sent) || !sent->may_leave(since)) continue;
    sent->left = true;
    sent->first_try = code.attempt == 0 ? since : sent->asked;
    sent->refused_at = core::kNever;
    sent->decided_from = sent->decisions.size();
    slot.begin(token);
    slot.last.crcs[code.attempt] = packet.crc;
    if (code.attempt == 0) note_passed_over(*sent, since);  // a retry: when the send began was not seen
    count_tries(*sent, code);
    return sent;
  }
  slot.begin(0);
  sources_[source].others_send = true;
  return nullptr;
}

// In an open chain more packets can be under way than there are numbers, and some may be alike to the last byte. The
// newest one that the node has not decided on yet stands for all of them.
Sent* Ledger::on_line(NodeId source, wire::Code code, NodeId destination, std::uint32_t crc, NodeId node) {
  if (source >= sources_.size()) return nullptr;
  const Slot& slot = on_line_slot(source, code, destination);
  Sent *newest = nullptr, *undecided = nullptr;
  const auto look_at = [&](const OnLine& packet) {
    Sent* sent = packet.crcs[code.attempt] == crc ? find(source, packet.token) : nullptr;
    if (sent == nullptr) return;
    if (newest == nullptr) newest = sent;
    if (sent->decided_by(node)) return;
    if (undecided == nullptr)
      undecided = sent;
    else
      undecided->has_twin = sent->has_twin = true;
  };
  look_at(slot.last);
  std::for_each(slot.former.rbegin(), slot.former.rend(), look_at);
  return undecided ? undecided : newest;
}

void Ledger::returned_damaged(NodeId source, bool interrupt) {
  Outstanding& outstanding = sources_[source].outstanding[interrupt ? 1 : 0];
  outstanding.damaged = true;
  if (Sent* sent = find(source, outstanding.token)) sent->may_have_failed = true;
}

Ledger::Return Ledger::returned(NodeId source, wire::Code code, NodeId destination, std::uint32_t crc) {
  Outstanding& outstanding = sources_[source].outstanding[code.interrupt ? 1 : 0];
  const OnLine& last = on_line_slot(source, code, destination).last;
  const int packet = wire::Code{code.interrupt, 0, code.sequence, code.incarnation}.byte();
  const bool same = outstanding.awaited && outstanding.token != 0 && outstanding.token == last.token &&
                    outstanding.packet == packet && outstanding.attempt == code.attempt &&
                    last.crcs[code.attempt] == crc;
  if (!same) return {};
  outstanding.awaited = false;
  Sent* sent = find(source, outstanding.token);
  return {sent, sent && !outstanding.damaged && !sent->ended};  // one that was cancelled while out is not repeated
}

void Ledger::receiver_forgot(NodeId source, NodeId receiver, Time at) {
  for (Sent& sent : sources_[source].sent)
    if (!sent.ended && (sent.destination == receiver || sent.destination == wire::kBroadcast)) sent.forgotten_at = at;
}

bool Ledger::has_taken(const core::ReceivedPacket& packet, NodeId node) const {
  if (packet.source >= sources_.size()) return false;  // a core that looks at no CRC gives out anything
  const auto& sent = sources_[packet.source].sent;
  return std::any_of(sent.begin(), sent.end(), [&](const Sent& s) {
    const auto by_it = [&](const Sent::Decision& d) { return d.node == node && d.taken; };
    return s.is(packet) && std::any_of(s.decisions.begin(), s.decisions.end(), by_it);
  });
}

void Ledger::come_home(Sent* sent, int fbc, Time at) {
  if (!sent) return;
  sent->in_doubt = fbc < 0;
  sent->final = fbc > 0 || (fbc == 0 && (sent->destination == wire::kBroadcast || sent->interrupt()));
  if (!sent->final) sent->refused_at = at;
  if (fbc <= 0) sent->first_refused = std::min(sent->first_refused, at);
  sent->home_at = at;
  sent->home_fbc = fbc;
}

void Ledger::take(Sent* sent, const wire::PacketFields& packet, NodeId node, Time at) {
  if (!sent) {
    if (!sources_[packet.source()].others_send)
      complain_(Promise::undamaged,
                node_words(node) + " took a packet that " + node_words(packet.source()) + " did not send");
    return;
  }
  if (sent->destination != node && (sent->destination != wire::kBroadcast || sent->source == node))
    complain_(Promise::undamaged, sent->name() + " was taken by " + node_words(node));
  const bool first_try = packet.code().attempt == 0;
  const auto may_be_forgotten = [&](const Sent::Decision& d) {
    return first_try && (d.at < forgotten_before_[node] || (may_have_copy(*sent) && d.at < started_[node]));
  };
  for (const Sent::Decision& decision : sent->decisions)
    if (decision.taken && decision.node == node && !may_be_forgotten(decision))
      complain_(Promise::exactly_once, sent->name() + " was taken twice by " + node_words(node));
  sent->decisions.push_back({node, true, at});
  check_order(*sent, node);
}

void Ledger::check_order(const Sent& sent, NodeId node) {
  if (sent.has_twin) return;
  std::uint32_t& newest = newest_[(std::size_t{node} * sources_.size() + sent.source) * 5 + sent.queue];
  if (sent.token < newest)
    complain_(Promise::in_order,
              sent.name() + " was taken by " + node_words(node) + " after " + std::to_string(newest));
  newest = std::max(newest, sent.token);
}

void Ledger::cancel(NodeId source, Time now) {
  for (const auto& waiting : sources_[source].waiting)
    for (const std::uint32_t token : waiting)
      if (Sent* sent = find(source, token)) sent->cancelled_at = std::min(sent->cancelled_at, now);
  for (Sent& sent : sources_[source].sent)
    if (!sent.ended && sent.source_incarnation == sources_[source].incarnation)
      sent.cancel_due = std::min(sent.cancel_due, now);
}

// ---- results --------------------------------------------------------------------------------

const Sent* Ledger::end(NodeId source, const core::SendEnded& end, Time at) {
  if (end.owner != kAskedByRing) return nullptr;
  Sent* sent = find(source, end.token);
  if (!sent) {
    if (end.token < sources_[source].first_token)
      complain_(Promise::one_result,
                "send " + std::to_string(end.token) + " of " + node_words(source) + " ended again, long after its end");
    return nullptr;
  }
  if (sent->source_incarnation != sources_[source].incarnation)
    complain_(Promise::one_result, sent->name() + " ended, and its node has restarted since");
  if (sent->ended) {
    complain_(Promise::one_result, sent->name() + " has two results");
    return nullptr;
  }
  sent->ended = true;
  sent->ended_at = at;
  sent->end = end;
  Outstanding& outstanding = sources_[source].outstanding[end.interrupt ? 1 : 0];
  if (outstanding.token == end.token && end.outcome != Outcome::cancelled) outstanding.awaited = false;
  check_result(*sent);
  check_measures(*sent);
  return sent;
}

void Ledger::check_result(const Sent& sent) {
  const Outcome outcome = sent.end.outcome;
  const auto complain = [&](const char* what) {
    complain_(Promise::true_result, sent.name() + " ended " + core::to_string(outcome) + what);
  };
  const bool broadcast = sent.destination == wire::kBroadcast;
  if (outcome == Outcome::delivered && !sent.taken() && !sent.may_be_taken) complain(", and nobody has taken it");
  // A line has duplicated the packet: the destination took one copy and died; the other one came home untaken.
  if (outcome == Outcome::no_such_node && sent.taken() && !may_have_copy(sent)) complain(", and somebody has taken it");
  if (outcome == Outcome::refused && !broadcast && sent.taken()) complain(", and it was taken");
  if (outcome == Outcome::rejected && sent.left) complain(", and it was on the line");
}

// The round trip is that of the last try, from its first byte out to its last bit back; 0 if it did not come home, or
// if that was not what ended it. (protocol.md section 4.6)
void Ledger::check_measures(const Sent& sent) {
  if (sent.in_doubt) return;
  const bool home = sent.home_at == sent.ended_at;
  const core::Duration seen = home ? sent.home_at - sent.last_try : core::Duration{0};
  const core::Duration told = sent.end.round_trip;
  const bool may_be_none = sent.end.outcome != Outcome::delivered && sent.end.outcome != Outcome::no_such_node;
  if (told != seen && !sent.clock_stood && !(may_be_none && told.count() == 0))
    complain_(Promise::true_result, sent.name() + " ended " + core::to_string(sent.end.outcome) + " after " +
                                        std::to_string(core::picoseconds(told)) + " ps, and " +
                                        std::to_string(core::picoseconds(seen)) + " were seen");
  const Outstanding& outstanding = sources_[sent.source].outstanding[sent.interrupt() ? 1 : 0];
  const unsigned under_way = outstanding.unknown();  // perhaps its own
  // A node that starts over or folds in the instant of a try takes it off the line unseen. (protocol.md section 8.10)
  // If another try follows, its number tells of this one, too.
  const bool unheard = sent.end.outcome == Outcome::unconfirmed || sent.end.outcome == Outcome::lost;
  const unsigned unseen = (fold_back_ && unheard) || sent.end.outcome == Outcome::cancelled ? 1 : 0;
  for (const unsigned unknown : {0u, under_way, outstanding.before, unseen})
    if (sent.end.tries == sent.tries + unknown) return;
  complain_(Promise::true_result, sent.name() + " ended " + core::to_string(sent.end.outcome) + " after " +
                                      std::to_string(sent.end.tries) + " tries, and " + std::to_string(sent.tries) +
                                      " were seen");
}

// ---- restarts --------------------------------------------------------------------------------

void Ledger::clock_stood(NodeId source) {
  for (Sent& sent : sources_[source].sent)
    if (!sent.ended) sent.clock_stood = true;
}

void Ledger::start(NodeId node, Time now) {
  started_[node] = now;
  ++sources_[node].incarnation;
  for (auto& waiting : sources_[node].waiting) waiting.clear();
  sources_[node].outstanding = {};
}

void PassedOver::note(const Sent& waiting, const Sent& leaving, core::Time since) {
  const Promise promise = waiting.queue == leaving.queue ? Promise::in_order : Promise::priority_first;
  noted_.push_back(
      {waiting.source, waiting.token, since, promise, leaving.name() + " left while " + waiting.name() + " waited"});
}

void PassedOver::judge_noted(core::Time now) {
  for (const Noted& noted : noted_) {
    if (noted.since >= now) continue;
    const Sent* sent = ledger_.find(noted.source, noted.token);
    if (sent && !(sent->ended && sent->ended_at <= noted.since)) complain_(noted.promise, noted.what);
  }
  const auto over = [&](const Noted& noted) { return noted.since < now; };
  noted_.erase(std::remove_if(noted_.begin(), noted_.end(), over), noted_.end());
}

}  // namespace limb_ring::sim
