#include "judge/receiver_model.h"

#include <algorithm>

#include "wire/packet.h"

namespace limb_ring::sim {

using wire::PacketFields;

namespace {

/// A boot number that is lower by at most this is of an earlier incarnation. (protocol.md section 4.10)
constexpr std::uint64_t kEarlier = 1000;

bool is_earlier(std::uint64_t boot, std::uint64_t than) { return than > boot && than - boot <= kEarlier; }

}  // namespace

ReceiverModel::ReceiverModel(const core::Settings& settings)
    : id_(settings.id),
      falls_into_parts_(settings.falls_into_parts()),
      wired_(settings.wired),
      horizon_(settings.send_timeout()),
      pages_(256) {}

// ---- the page of a source ------------------------------------------------------------------------

ReceiverModel::Entry& ReceiverModel::entry(const PacketFields& packet) {
  const bool broadcast = packet.destination() == wire::kBroadcast;
  return pages_[packet.source()].entries[(packet.code().interrupt ? 2u : 0u) + (broadcast ? 1u : 0u)];
}

bool ReceiverModel::is_old(const Entry& e, Time now) const { return now - e.decided > wire::kTries * horizon_; }

void ReceiverModel::age(Page& page, Time now) const {
  for (Entry& e : page.entries) {
    if (!e.any_sequence && is_old(e, now)) e = {};
    e.aged = true;
  }
}

template <class Forget>
bool ReceiverModel::hear_boot(NodeId source, std::uint64_t boot, Forget forget) {
  Page& page = pages_[source];
  if (page.boot == boot) return true;
  if (is_earlier(boot, page.boot)) return false;
  forget(page);
  page.known = true;
  page.from_packet = page.any_incarnation = false;
  page.incarnation = wire::incarnation_of(boot);
  page.boot = boot;
  return true;
}

// @return false if it is of an earlier incarnation
bool ReceiverModel::hear(const PacketFields& packet, Time at) {
  Page& page = pages_[packet.source()];
  const auto empty = [](Page& p) {
    const Tristate peer_known = p.peer_known;
    p = {};
    p.peer_known = peer_known;
  };
  bool heard = true;
  if (const auto hello = wire::decode_hello(packet.data())) {
    heard = hear_boot(packet.source(), hello->boot, empty);
  } else if (const auto beacon = wire::decode_beacon(packet.data())) {
    heard = hear_boot(packet.source(), beacon->boot, [&](Page& p) {
      if (p.incarnation != wire::incarnation_of(beacon->boot)) empty(p);
      if (!p.from_packet) age(p, at);
    });
  } else {
    return true;
  }
  if (heard) page.peer_known = Tristate::yes;
  return heard;
}

// The first beacon that is heard of a node does not say so, nor does a hello that remembers if no start was missed.
bool ReceiverModel::may_tell_of_forgetting(const PacketFields& packet, Tristate received) const {
  if (received == Tristate::unknown) return true;
  const Page& page = pages_[packet.source()];
  const auto hello = wire::decode_hello(packet.data());
  const auto beacon = wire::decode_beacon(packet.data());
  if (!hello && !beacon) return false;
  if (page.peer_known == Tristate::unknown || page.any_incarnation) return true;
  const bool known = page.peer_known == Tristate::yes;
  const std::uint64_t boot = hello ? hello->boot : beacon->boot;
  if (is_earlier(boot, page.boot) || (known && page.boot == boot)) return false;
  const bool goes_on = hello && hello->remembers && known && boot == page.boot + 1;
  return (hello || known) && !goes_on;
}

// @return false if it is of an earlier incarnation
bool ReceiverModel::meet(const PacketFields& packet) {
  Page& page = pages_[packet.source()];
  const std::uint8_t incarnation = packet.code().incarnation;
  const int later = page.known ? (incarnation - page.incarnation) & 3 : 2;
  if (later == 0) return true;
  if (later == 3) return false;
  page.entries = {};
  page.known = page.from_packet = true;
  page.incarnation = incarnation;
  return true;
}

// ---- packets ----------------------------------------------------------------------------------------

bool ReceiverModel::addressed(const PacketFields& packet) const {
  if (packet.destination() == wire::kBroadcast) return packet.source() != id_;
  return packet.destination() == id_;
}

Tristate ReceiverModel::is_unknown_peers_retry(const PacketFields& packet) const {
  const bool may_be = falls_into_parts_ && packet.code().attempt > 0 && packet.source() != id_;
  if (!may_be || pages_[packet.source()].peer_known == Tristate::yes) return Tristate::no;
  return pages_[packet.source()].peer_known == Tristate::no ? Tristate::yes : Tristate::unknown;
}

// Nobody outside knows whether `packet` was received.
void ReceiverModel::doubt(const PacketFields& packet) {
  Page& page = pages_[packet.source()];
  if (!packet.code().interrupt && wire::is_control(packet)) {
    page.any_incarnation = true;
    if (page.peer_known == Tristate::no) page.peer_known = Tristate::unknown;
    for (Entry& e : page.entries) e.any_sequence = true;
  } else if (addressed(packet)) {
    if (!page.known || page.incarnation != packet.code().incarnation) page.any_incarnation = true;
    Entry& e = entry(packet);
    e.any_sequence = true;
    e.left_behind = core::kNever;
  }
}

// Nothing: it is none.
std::optional<ReceiverModel::Answer> ReceiverModel::of_unaware_peers_retry(const PacketFields& packet, Time at) {
  // The hello may have gone round in one of two parts alone.
  const core::Duration tries = falls_into_parts_ ? (wire::kTries + 1) * horizon_ : core::Duration{0};
  const auto known_to_all = [&](Time announced) { return announced != core::kNever && at - announced >= tries; };
  if (packet.code().attempt == 0 || known_to_all(announced_)) return std::nullopt;
  if (!known_to_all(perhaps_announced_)) return Answer::none;
  return doubt(packet), Answer::unknown;
}

// Nothing: its number is new.
std::optional<ReceiverModel::Answer> ReceiverModel::of_known(const Entry& e, const PacketFields& packet,
                                                             Time at) const {
  if (e.any_sequence) return Answer::unknown;
  if (e.decision == Decision::none || e.sequence != packet.code().sequence) return std::nullopt;
  const bool fresh = !e.aged && at - e.decided <= horizon_;
  if (!fresh && packet.code().attempt == 0) return std::nullopt;
  if (e.decision == Decision::unknown) return Answer::unknown;
  if (e.in_doubt || (falls_into_parts_ && is_old(e, at))) return Answer::none;
  return e.decision == Decision::taken ? Answer::repeats_taken : Answer::repeats_refused;
}

void ReceiverModel::decide(Entry& e, const PacketFields& packet, Answer answer, Time at) {
  const Decision decision = answer == Answer::takes || answer == Answer::control ? Decision::taken
                            : answer == Answer::refuses                          ? Decision::refused
                                                                                 : Decision::unknown;
  e = {at, packet.code().sequence, decision};
}

ReceiverModel::Answer ReceiverModel::data(const PacketFields& packet, Tristate received, Tristate has_buffer, Time at) {
  if (received == Tristate::unknown) return doubt(packet), Answer::unknown;
  const bool control = wire::is_control(packet);
  Page& page = pages_[packet.source()];
  if (control && page.any_incarnation) {
    hear(packet, at);
    page.any_incarnation = false;
    for (Entry& e : page.entries) e.any_sequence = true;
    return Answer::unknown;
  }
  if (control && packet.source() != id_ && !hear(packet, at)) return Answer::refuses;
  const Tristate unknown_peers_retry = is_unknown_peers_retry(packet);
  if (unknown_peers_retry == Tristate::yes || !addressed(packet)) return Answer::none;
  if (unknown_peers_retry == Tristate::unknown || page.any_incarnation) return doubt(packet), Answer::unknown;
  if (!meet(packet)) return Answer::refuses;
  Entry& e = entry(packet);
  if (control) return decide(e, packet, Answer::control, at), Answer::control;
  const std::optional<Answer> known = of_known(e, packet, at);
  if (known && *known != Answer::unknown) return *known;
  Answer answer = Answer::unknown;
  if (!known) {
    if (const auto unaware = of_unaware_peers_retry(packet, at)) return *unaware;
    const bool refuses = joined_ == Tristate::no || !cpu_present_ || has_buffer == Tristate::no;
    const bool takes = joined_ == Tristate::yes && has_buffer == Tristate::yes;
    answer = refuses ? Answer::refuses : takes ? Answer::takes : Answer::unknown;
  }
  decide(e, packet, answer, at);
  return answer;
}

ReceiverModel::Answer ReceiverModel::interrupt(const PacketFields& packet, Tristate received, Time at) {
  if (received == Tristate::unknown) return doubt(packet), Answer::unknown;
  const Tristate unknown_peers_retry = is_unknown_peers_retry(packet);
  if (unknown_peers_retry == Tristate::yes || !addressed(packet)) return Answer::none;
  if (unknown_peers_retry == Tristate::unknown || pages_[packet.source()].any_incarnation)
    return doubt(packet), Answer::unknown;
  if (!meet(packet)) return Answer::refuses;
  Entry& e = entry(packet);
  const std::optional<Answer> known = of_known(e, packet, at);
  if (known && *known != Answer::unknown) return *known;
  Answer answer = Answer::unknown;
  if (!known) {
    if (const auto unaware = of_unaware_peers_retry(packet, at)) return *unaware;
    answer = wired_[wire::factor_of(packet.last())] ? Answer::takes : Answer::refuses;
  }
  decide(e, packet, answer, at);
  return answer;
}

// ---- the node ---------------------------------------------------------------------------------------

void ReceiverModel::says_hello(std::uint64_t boot) {
  hear_boot(id_, boot, [](Page& page) { page = {}; });
}

void ReceiverModel::announce(bool sure, Time at) {
  perhaps_announced_ = std::min(perhaps_announced_, at);
  if (sure) announced_ = std::min(announced_, at);
}

template <class Change>
void ReceiverModel::each_entry(Change change) {
  for (Page& page : pages_)
    for (Entry& e : page.entries) change(e);
}

void ReceiverModel::input_changes(Time now) {
  each_entry([now](Entry& e) { e.left_behind = std::min(e.left_behind, now); });
}

// What it decided before its input was last lost it forgets. If the ring falls into parts, it keeps what a copy may
// still come of, and gives no verdict on it.
void ReceiverModel::start_over(bool crossed, Time now) {
  begin_incarnation();
  each_entry([&](Entry& e) {
    if (falls_into_parts_) {
      if (now - e.decided > horizon_ && !e.any_sequence) e = {};
      e.in_doubt = true;
    } else if (crossed && e.left_behind == now) {
      e.any_sequence = true;
    } else if (e.left_behind != core::kNever) {
      e = {};
    }
  });
  for (Page& page : pages_) page.peer_known = Tristate::no;
}

// If it did not start over, what it had decided still holds; nobody outside knows.
void ReceiverModel::may_start_over() {
  joined_ = Tristate::no;
  announced_ = core::kNever;
  each_entry([&](Entry& e) {
    if (e.decision != Decision::none && (falls_into_parts_ || e.left_behind != core::kNever)) e.any_sequence = true;
  });
  for (Page& page : pages_)
    if (page.peer_known == Tristate::yes) page.peer_known = Tristate::unknown;
}

void ReceiverModel::begin_incarnation() {
  joined_ = Tristate::no;
  announced_ = perhaps_announced_ = core::kNever;
}

void ReceiveBuffers::put(Sent* sent, NodeId source, std::uint8_t priority, Time at, bool sure) {
  unread_[priority].push_back({source, sent ? sent->token : 0, at, sure});
  if (!sure) ++doubtful_[priority];
  if (sent) ++sent->unread;
}

void ReceiveBuffers::drop_front(std::uint8_t priority) {
  const Unread& front = unread_[priority].front();
  if (!front.sure) --doubtful_[priority];
  if (Sent* sent = ledger_.find(front.source, front.token)) --sent->unread;
  unread_[priority].pop_front();
}

bool ReceiveBuffers::may_be(const Unread& unread, const core::ReceivedPacket& packet) const {
  const Sent* sent = ledger_.find(unread.source, unread.token);
  return sent ? sent->is(packet) : unread.source == packet.source;
}

void ReceiveBuffers::read(const core::ReceivedPacket& packet, Time now) {
  check_priority(packet, now);
  auto& unread = unread_[packet.priority];
  const auto was_not_taken = [&](const Unread& u) { return !u.sure && (u.at != packet.at || !may_be(u, packet)); };
  while (!unread.empty() && was_not_taken(unread.front())) drop_front(packet.priority);
  if (unread.empty()) return never_took(packet);
  if (!may_be(unread.front(), packet)) {
    if (ledger_.has_taken(packet, node_)) return never_took(packet);
    const Sent* sent = ledger_.find(unread.front().source, unread.front().token);
    complain_(Promise::undamaged,
              (sent ? sent->name() : "a packet") + " came to the CPU of " + node_words(node_) + " changed");
  }
  drop_front(packet.priority);
}

void ReceiveBuffers::never_took(const core::ReceivedPacket& packet) const {
  const bool again = ledger_.has_taken(packet, node_);
  complain_(again ? Promise::exactly_once : Promise::undamaged,
            node_words(node_) + " gave its CPU a packet of " + node_words(packet.source) +
                (again ? " that it had taken before" : " that it was not to take"));
}

void ReceiveBuffers::check_priority(const core::ReceivedPacket& packet, Time now) const {
  // What is in before an earlier one of its priority waits for that. (a line that gives out at once what it held back)
  const auto waits = [&](const std::deque<Unread>& unread) {
    const auto stops = [&](const Unread& one) { return one.sure || one.at > now; };
    const auto first = std::find_if(unread.begin(), unread.end(), stops);
    return first != unread.end() && first->at <= now;
  };
  for (std::uint8_t higher = 0; higher < packet.priority; ++higher)
    if (waits(unread_[higher]))
      complain_(Promise::priority_first, "the CPU of " + node_words(node_) + " got a packet of priority " +
                                             std::to_string(packet.priority) + " while one of priority " +
                                             std::to_string(higher) + " waited");
}

void ReceiveBuffers::flush() {
  for (std::uint8_t priority = 0; priority < unread_.size(); ++priority)
    while (!unread_[priority].empty()) drop_front(priority);
}

}  // namespace limb_ring::sim
