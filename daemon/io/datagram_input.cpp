#include "io/datagram_input.h"

#include <algorithm>
#include <iterator>

namespace limb_ring::link {

DatagramInput::DatagramInput(const InputSettings& settings, InputLine& line, InputHandler& handler, InputReport& report,
                             Upstream& upstream, Send send)
    : self_(settings.self),
      timing_(settings.timing),
      line_(line),
      handler_(handler),
      report_(report),
      upstream_(upstream),
      send_(std::move(send)),
      admission_(settings.self, settings.order, settings.names),
      silence_(settings.timing) {}

void DatagramInput::close() {
  if (closed_) return;
  if (from_) tell(LinkHeaderType::refuse, session_, Refusal::closing);
  closed_ = true;
  from_.reset();
}

void DatagramInput::take(wire::ByteView datagram, const UdpAddress& sender, Time now) {
  if (closed_) return;
  ++report_.counters.datagrams;
  const auto header = parse_header(datagram);
  if (!header) return on_unknown_peer(kNoNode);
  if (asks_to_connect(header->type)) return on_connect(*header, datagram, sender, now);
  if (header->ring != self_.ring) return report_.unknown_peer("a datagram of another ring");
  if (self_.key && !is_unsealed(*header, datagram)) return;
  if (header->type == LinkHeaderType::slices) {
    take_slices(*header, datagram.from(kLinkHeaderSize), sender, now);
  } else if (header->type == LinkHeaderType::bye && present(*header)) {
    lose("its end was closed");
  }
}

void DatagramInput::on_unknown_peer(const std::string& why) {
  report_.unknown_peer(why);
  if (report_.report_once(why)) handler_.on_unknown_peer(why);
}

bool DatagramInput::present(const LinkHeader& header) const {
  return from_ && *from_ == header.sender && session_.number == header.session;
}

void DatagramInput::take_slices(const LinkHeader& header, wire::ByteView bytes, const UdpAddress& sender, Time now) {
  if (!present(header)) {
    const auto offer = offers_.find(header.sender);
    if (offer == offers_.end() || offer->second.number != header.session) return on_stale(header, sender);
    const Session session = offer->second;
    offers_.erase(offer);
    if (!take_up(session, header, now)) return;
  }
  if (closed_) return;
  const SequenceCheck::Arrival arrival = sequence_.check(header.sequence);
  if (!arrival.fresh) {  // no sign of life: if nothing else comes, one forged number has put all of them in the past
    ++report_.counters.datagrams_duplicate;
    return;
  }
  silence_.heard();
  report_.counters.datagrams_lost += arrival.lost;
  if (arrival.lost != 0) gap();
  hand_on(bytes);
}

void DatagramInput::hand_on(wire::ByteView bytes) {
  do {  // a datagram without a slice is malformed, too
    const wire::SliceParse parse = wire::parse_slice(bytes);
    if (parse.status != wire::SliceParse::Status::slice) {
      ++report_.counters.malformed;
      return gap();
    }
    bytes = bytes.from(parse.consumed);
    if (parse.slice.kind == wire::SliceKind::idle) {
      ++report_.counters.idle_slices;
      continue;
    }
    ++report_.counters.slices;
    batch_ = true;
    handler_.on_slice(parse.slice);
  } while (!bytes.empty() && !closed_);
}

void DatagramInput::gap() {
  batch_ = true;
  handler_.on_input_gap();
}

void DatagramInput::end_batch() {
  if (batch_ && !closed_) handler_.on_batch_end();
  batch_ = false;
}

void DatagramInput::on_connect(const LinkHeader& header, wire::ByteView datagram, const UdpAddress& sender, Time now) {
  if (!may_ask(header, datagram, sender)) return;
  Nonce asker{};
  if (self_.key) std::copy_n(datagram.data + kConnectSize, asker.size(), asker.begin());
  const Agreement theirs = load_agreement(datagram.data + kLinkHeaderSize);
  if (auto refuse = admission_.judge(header, theirs, upstream_.from()))
    return turn_away(header, *refuse, asker, sender);
  const auto is_its = [&](const Session& session) {
    return session_nonce(session.number) == session_nonce(header.session) && session.asker == asker;
  };
  if (from_ == header.sender && is_its(session_)) return accept(session_, header.sender);
  const auto found = offers_.find(header.sender);
  if (found == offers_.end() || !is_its(found->second)) offers_[header.sender] = new_session(header, asker);
  Session& offer = offers_[header.sender];
  offer.address = sender;
  offer.since = now;
  accept(offer, header.sender);
}

DatagramInput::Session DatagramInput::new_session(const LinkHeader& connect, const Nonce& asker) const {
  Session session;
  session.number = (connect.session & 0xFFFFFFFF00000000u) | fresh_nonce();
  if (!self_.key) return session;
  session.asker = asker;
  session.answerer = fresh_long_nonce();
  const SessionKeys keys = self_.key->session({asker, session.answerer, session.number, connect.sender, self_.id});
  session.sealer.emplace(keys.backward);
  session.opener.emplace(keys.forward);
  return session;
}

bool DatagramInput::may_ask(const LinkHeader& connect, wire::ByteView datagram, const UdpAddress& sender) {
  if (connect.version != kLinkVersion) {  // of that one the header alone is known
    hint(connect, Refusal::wrong_version, sender);
  } else if (connect.ring != self_.ring) {
    hint(connect, Refusal::wrong_ring, sender);
  } else if (connect.type != LinkHeaderType::connect_keyed && self_.key) {
    hint(connect, Refusal::needs_key, sender);
  } else if (connect.type == LinkHeaderType::connect_keyed && !self_.key) {
    hint(connect, Refusal::no_key, sender);
  } else if (self_.key) {
    return is_authentic(connect, datagram, sender);
  } else if (datagram.size < kConnectSize) {
    on_unknown_peer(kNoNode);
  } else {
    return true;
  }
  return false;
}

bool DatagramInput::is_authentic(const LinkHeader& connect, wire::ByteView datagram, const UdpAddress& sender) {
  if (datagram.size != kKeyedConnectSize) {
    ++report_.counters.datagrams_truncated;
    return false;
  }
  Nonce asker;
  std::copy_n(datagram.data + kConnectSize, asker.size(), asker.begin());
  const std::size_t signed_size = kKeyedConnectSize - kTagSize;
  if (self_.key->check(datagram.first(signed_size), asker, self_.id, datagram.data + signed_size)) return true;
  hint(connect, Refusal::wrong_key, sender);
  return false;
}

bool DatagramInput::is_unsealed(const LinkHeader& header, wire::ByteView& datagram) {
  if (datagram.size < kLinkHeaderSize + kSealSize) {
    ++report_.counters.datagrams_truncated;
    return false;
  }
  const auto offer = offers_.find(header.sender);
  Session* session = present(header) ? &session_ : nullptr;
  if (session == nullptr && offer != offers_.end() && offer->second.number == header.session) session = &offer->second;
  if (session == nullptr) {
    count_stale(header);
    return false;  // without an answer: who sent it has not proved that it has the key
  }
  const Opener::Verdict verdict = session->opener->open(datagram);
  count(verdict, report_.counters);
  datagram = datagram.first(datagram.size - kSealSize);
  return verdict == Opener::Verdict::good;
}

/// An answer that is not authenticated, for the people at the other end. It is shorter than the question, and there is
/// at most one per tick, so that nobody can be flooded by it.
void DatagramInput::hint(const LinkHeader& connect, Refusal refusal, const UdpAddress& sender) {
  LinkHeader refuse = admission_.header(LinkHeaderType::refuse, refusal);
  refuse.session = connect.session;
  if (!hinted_) {
    const auto bytes = encode(refuse);
    send({bytes.data(), bytes.size()}, sender);
  }
  hinted_ = true;
  report_.turned_away(admission_.label(connect.sender), connect, refuse, handler_);
}

void DatagramInput::turn_away(const LinkHeader& connect, LinkHeader& refuse, const Nonce& asker,
                              const UdpAddress& sender) {
  refuse.session = connect.session;
  const auto bytes = encode(refuse);
  send_tagged({bytes.data(), bytes.size()}, asker, connect.sender, sender);
  report_.turned_away(admission_.label(connect.sender), connect, refuse, handler_);
}

void DatagramInput::accept(const Session& session, std::uint8_t node) {
  ++report_.counters.offers;
  LinkHeader header = admission_.header(LinkHeaderType::accept);
  header.session = session.number;
  std::array<std::uint8_t, kLinkHeaderSize + sizeof(Nonce)> bytes;
  store_header(bytes.data(), header);
  std::copy(session.answerer.begin(), session.answerer.end(), bytes.begin() + kLinkHeaderSize);
  const std::size_t size = self_.key ? bytes.size() : kLinkHeaderSize;
  send_tagged({bytes.data(), size}, session.asker, node, session.address);
}

// A nearer neighbour may have come in since the offer was made.
bool DatagramInput::take_up(Session offer, const LinkHeader& header, Time now) {
  if (admission_.judge(header, upstream_.from()) != Refusal::none) {
    ++report_.counters.refused;
    tell(LinkHeaderType::refuse, offer, Refusal::busy);
    return false;
  }
  upstream_.give_way(header.sender);
  if (closed_) return true;
  upstream_.comes_by(line_);
  session_ = offer;
  from_ = header.sender;
  sequence_.restart();
  silence_.restart(now);
  report_.came_up(header.sender);
  handler_.on_input_up(header.sender);
  return true;
}

void DatagramInput::replace(std::uint8_t by) {
  ++report_.counters.replaced;
  tell(LinkHeaderType::refuse, session_, Refusal::replaced);
  lose("replaced by node " + std::to_string(by));
}

void DatagramInput::count_stale(const LinkHeader& header) {
  ++report_.counters.datagrams_stale;
  report_.counters.last_stale_from = header.sender;
}

void DatagramInput::on_stale(const LinkHeader& header, const UdpAddress& sender) {
  count_stale(header);
  if (told_stale_) return;
  told_stale_ = true;
  Session none;
  none.number = header.session;
  none.address = sender;
  tell(LinkHeaderType::refuse, none, Refusal::unknown_session);
}

void DatagramInput::lose(std::string_view reason) {
  if (batch_) handler_.on_batch_end();
  batch_ = false;
  if (closed_) return;
  ++report_.counters.losses;
  from_.reset();
  handler_.on_input_lost(reason);
}

bool DatagramInput::tick(Time now) {
  told_stale_ = false;
  hinted_ = false;
  drop_old_offers(now);
  if (!from_) return false;
  tell(LinkHeaderType::alive, session_);
  return silence_.tick(now);
}

void DatagramInput::lose_if_silent() {
  if (!from_ || !silence_.still()) return;
  ++report_.counters.silences;
  tell(LinkHeaderType::refuse, session_, Refusal::unknown_session);
  lose(kSilent);
}

bool DatagramInput::is_bye(wire::ByteView datagram) {
  const auto header = parse_header(datagram);
  if (!header || header->type != LinkHeaderType::bye || !present(*header)) return false;
  return !self_.key || is_unsealed(*header, datagram);
}

void DatagramInput::given_up() {
  ++report_.counters.given_up;
  lose(kGivenUp);
}

void DatagramInput::drop_old_offers(Time now) {
  for (auto i = offers_.begin(); i != offers_.end();) {
    i = now - i->second.since > timing_.handshake() ? offers_.erase(i) : std::next(i);
  }
}

void DatagramInput::tell(LinkHeaderType type, Session& session, Refusal refusal) {
  LinkHeader header = admission_.header(type, refusal);
  header.session = session.number;
  std::array<std::uint8_t, kLinkHeaderSize + kSealSize> bytes;
  store_header(bytes.data(), header);
  if (session.sealer) session.sealer->seal(bytes.data(), kLinkHeaderSize);
  send({bytes.data(), session.sealer ? bytes.size() : kLinkHeaderSize}, session.address);
}

void DatagramInput::send_tagged(wire::ByteView message, const Nonce& asker, std::uint8_t to,
                                const UdpAddress& address) {
  if (!self_.key) return send(message, address);
  std::vector<std::uint8_t> bytes(message.begin(), message.end());
  const Tag tag = self_.key->tag(message, asker, to);
  bytes.insert(bytes.end(), tag.begin(), tag.end());
  send({bytes.data(), bytes.size()}, address);
}

void DatagramInput::send(wire::ByteView datagram, const UdpAddress& to) {
  if (!closed_) send_(datagram, to);
}

}  // namespace limb_ring::link
