#include "link/udp_input.h"

#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include "link/unix_socket.h"

namespace limb_ring::link {
namespace {

constexpr std::size_t kReadSize = 64 * 1024;
/// Reads per wake-up at most, so that the timers get their turn under any load.
constexpr int kReadsPerDrain = 64;

}  // namespace

UdpInput::UdpInput(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler,
                   InputReport& report, Upstream& upstream)
    : io_(io),
      settings_(settings),
      handler_(handler),
      report_(report),
      upstream_(upstream),
      admission_(settings.self, settings.order, settings.names),
      socket_(listen_udp(io, settings.endpoint)),
      buffer_(kReadSize),
      silence_(settings.timing),
      ticker_(io, settings.timing.idle, [this](Time now) { tick(now); }) {}

void UdpInput::close() {
  if (closed_) return;
  if (from_) tell(LinkHeaderType::refuse, session_, Refusal::closing);
  closed_ = true;
  ticker_.stop();
  watch_.stop();
  from_.reset();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

std::optional<std::uint8_t> UdpInput::from() const { return from_; }

void UdpInput::start() {
  watch_ = event_loop::Watch(io_, socket_.native_handle(), EPOLLIN, [this](std::uint32_t) {
    const auto self = shared_from_this();  // the handler may close the input
    drain();
  });
}

void UdpInput::drain() {
  UdpAddress sender;
  int reads = 0;
  for (; reads < kReadsPerDrain && !closed_; ++reads) {
    const UdpRead read = receive_run(socket_.native_handle(), buffer_.data(), buffer_.size(), sender);
    if (read.size < 0) break;
    take_run(static_cast<std::size_t>(read.size), read.segment, sender);
  }
  if (reads == kReadsPerDrain && !closed_) watch_.call_again();
  if (batch_ && !closed_) handler_.on_batch_end();
  batch_ = false;
}

void UdpInput::take_run(std::size_t size, std::size_t segment, const UdpAddress& sender) {
  ++report_.counters.reads;
  report_.counters.bytes += size;
  wire::ByteView rest{buffer_.data(), size};
  do {
    const std::size_t one = std::min(segment, rest.size);
    ++report_.counters.datagrams;
    take(rest.first(one), sender);
    rest = rest.from(one);
  } while (!rest.empty() && !closed_);
}

void UdpInput::take(wire::ByteView datagram, const UdpAddress& sender) {
  const auto header = parse_header(datagram);
  if (!header) return on_unknown_peer(kNoNode);
  if (asks_to_connect(header->type)) return on_connect(*header, datagram, sender);
  if (header->ring != settings_.self.ring) return report_.unknown_peer("a datagram of another ring");
  if (settings_.self.key && !is_unsealed(*header, datagram)) return;
  if (header->type == LinkHeaderType::slices) {
    take_slices(*header, datagram.from(kLinkHeaderSize), sender);
  } else if (header->type == LinkHeaderType::bye && present(*header)) {
    lose("its end was closed");
  }
}

void UdpInput::on_unknown_peer(const std::string& why) {
  report_.unknown_peer(why);
  if (report_.report_once(why)) handler_.on_unknown_peer(why);
}

bool UdpInput::present(const LinkHeader& header) const {
  return from_ && *from_ == header.sender && session_.number == header.session;
}

void UdpInput::take_slices(const LinkHeader& header, wire::ByteView bytes, const UdpAddress& sender) {
  if (!present(header) && !take_up_offer(header)) return on_stale(header, sender);
  if (closed_) return;
  silence_.heard();
  const SequenceCheck::Verdict verdict = sequence_.check(header.sequence);
  if (!verdict.fresh) {
    ++report_.counters.datagrams_duplicate;
    return;
  }
  report_.counters.datagrams_lost += verdict.lost;
  if (verdict.lost != 0) gap(verdict.lost);
  hand_on(bytes);
}

void UdpInput::hand_on(wire::ByteView bytes) {
  while (!bytes.empty() && !closed_) {
    const wire::SliceParse parse = wire::parse_slice(bytes);
    if (parse.status != wire::SliceParse::Status::slice) {
      ++report_.counters.malformed;
      return gap(1);
    }
    bytes = bytes.from(parse.consumed);
    if (parse.slice.kind == wire::SliceKind::idle) {
      ++report_.counters.idle_slices;
      continue;
    }
    ++report_.counters.slices;
    batch_ = true;
    handler_.on_slice(parse.slice);
  }
}

void UdpInput::gap(std::uint32_t lost) {
  batch_ = true;
  handler_.on_input_gap(lost);
}

void UdpInput::on_connect(const LinkHeader& header, wire::ByteView datagram, const UdpAddress& sender) {
  if (!may_ask(header, datagram, sender)) return;
  Nonce asker{};
  if (settings_.self.key) std::copy_n(datagram.data + kConnectSize, asker.size(), asker.begin());
  const Agreement theirs = load_agreement(datagram.data + kLinkHeaderSize);
  if (auto refuse = admission_.judge(header, theirs, upstream_.from()))
    return turn_away(header, *refuse, asker, sender);
  const auto is_its = [&](const Session& session) {
    return session_nonce(session.number) == session_nonce(header.session) && session.asker == asker;
  };
  if (from_ == header.sender && is_its(session_)) return accept(session_, header.sender);
  Session& offer = offers_[header.sender];
  if (!is_its(offer)) offer = new_session(header, asker);
  offer.address = sender;
  offer.since = Clock::now();
  accept(offer, header.sender);
}

UdpInput::Session UdpInput::new_session(const LinkHeader& connect, const Nonce& asker) const {
  Session session;
  session.number = (connect.session & 0xFFFFFFFF00000000u) | fresh_nonce();
  if (!settings_.self.key) return session;
  session.asker = asker;
  session.answerer = fresh_long_nonce();
  const SessionKeys keys =
      settings_.self.key->session({asker, session.answerer, session.number, connect.sender, settings_.self.id});
  session.sealer.emplace(keys.backward);
  session.opener.emplace(keys.forward);
  return session;
}

bool UdpInput::may_ask(const LinkHeader& connect, wire::ByteView datagram, const UdpAddress& sender) {
  if (connect.version != kLinkVersion) {  // of that one the header alone is known
    hint(connect, Refusal::wrong_version, sender);
  } else if (connect.ring != settings_.self.ring) {
    hint(connect, Refusal::wrong_ring, sender);
  } else if (connect.type != LinkHeaderType::connect_keyed && settings_.self.key) {
    hint(connect, Refusal::needs_key, sender);
  } else if (connect.type == LinkHeaderType::connect_keyed && !settings_.self.key) {
    hint(connect, Refusal::no_key, sender);
  } else if (settings_.self.key) {
    return is_authentic(connect, datagram, sender);
  } else if (datagram.size < kConnectSize) {
    on_unknown_peer(kNoNode);
  } else {
    return true;
  }
  return false;
}

bool UdpInput::is_authentic(const LinkHeader& connect, wire::ByteView datagram, const UdpAddress& sender) {
  if (datagram.size != kKeyedConnectSize) return ++report_.counters.datagrams_truncated, false;
  Nonce asker;
  std::copy_n(datagram.data + kConnectSize, asker.size(), asker.begin());
  const std::size_t signed_size = kKeyedConnectSize - kTagSize;
  if (settings_.self.key->check(datagram.first(signed_size), asker, settings_.self.id, datagram.data + signed_size))
    return true;
  hint(connect, Refusal::wrong_key, sender);
  return false;
}

bool UdpInput::is_unsealed(const LinkHeader& header, wire::ByteView& datagram) {
  if (datagram.size < kLinkHeaderSize + kSealSize) return ++report_.counters.datagrams_truncated, false;
  const auto offer = offers_.find(header.sender);
  Session* session = present(header) ? &session_ : nullptr;
  if (session == nullptr && offer != offers_.end() && offer->second.number == header.session) session = &offer->second;
  if (session == nullptr) return ++report_.counters.datagrams_stale, false;  // and no answer: a stranger gets none
  const Opener::Verdict verdict = session->opener->open(datagram);
  if (verdict == Opener::Verdict::forged) ++report_.counters.datagrams_forged;
  if (verdict == Opener::Verdict::replayed) ++report_.counters.datagrams_replayed;
  datagram = datagram.first(datagram.size - kSealSize);
  return verdict == Opener::Verdict::good;
}

/// An answer that nobody can trust, for the people at the other end. It is shorter than the question, and there is at
/// most one per tick: nothing for somebody who wants others flooded.
void UdpInput::hint(const LinkHeader& connect, Refusal refusal, const UdpAddress& sender) {
  LinkHeader refuse = admission_.header(LinkHeaderType::refuse, refusal);
  refuse.session = connect.session;
  if (!hinted_) {
    const auto bytes = encode(refuse);
    send({bytes.data(), bytes.size()}, sender);
  }
  hinted_ = true;
  report_.turned_away(admission_.label(connect.sender), connect, refuse, handler_);
}

void UdpInput::turn_away(const LinkHeader& connect, LinkHeader& refuse, const Nonce& asker, const UdpAddress& sender) {
  refuse.session = connect.session;
  const auto bytes = encode(refuse);
  send_tagged({bytes.data(), bytes.size()}, asker, connect.sender, sender);
  if (refuse.refusal == Refusal::busy) {
    ++report_.counters.refused;
  } else {
    report_.turned_away(admission_.label(connect.sender), connect, refuse, handler_);
  }
}

void UdpInput::accept(const Session& session, std::uint8_t node) {
  ++report_.counters.offers;
  LinkHeader header = admission_.header(LinkHeaderType::accept);
  header.session = session.number;
  std::array<std::uint8_t, kLinkHeaderSize + sizeof(Nonce)> bytes;
  store_header(bytes.data(), header);
  std::copy(session.answerer.begin(), session.answerer.end(), bytes.begin() + kLinkHeaderSize);
  const std::size_t size = settings_.self.key ? bytes.size() : kLinkHeaderSize;
  send_tagged({bytes.data(), size}, session.asker, node, session.address);
}

bool UdpInput::take_up_offer(const LinkHeader& header) {
  const auto found = offers_.find(header.sender);
  if (found == offers_.end() || found->second.number != header.session) return false;
  Session offer = found->second;
  offers_.erase(found);
  if (admission_.judge(header, upstream_.from()) != Refusal::none) {
    ++report_.counters.refused;
    tell(LinkHeaderType::refuse, offer, Refusal::busy);
    return false;
  }
  upstream_.give_way(header.sender);
  if (closed_) return true;
  upstream_.comes_by(*this);
  session_ = offer;
  from_ = header.sender;
  report_.refusals.forget(header.sender);
  sequence_.restart();
  silence_.restart(Clock::now());
  ++report_.counters.connects;
  report_.report_once.forget();
  handler_.on_input_up(header.sender);
  return true;
}

void UdpInput::replace(std::uint8_t by) {
  ++report_.counters.replaced;
  tell(LinkHeaderType::refuse, session_, Refusal::replaced);
  lose("replaced by node " + std::to_string(by));
}

void UdpInput::on_stale(const LinkHeader& header, const UdpAddress& sender) {
  ++report_.counters.datagrams_stale;
  if (told_stale_) return;
  told_stale_ = true;
  Session none;
  none.number = header.session;
  none.address = sender;
  tell(LinkHeaderType::refuse, none, Refusal::unknown_session);
}

void UdpInput::lose(std::string_view reason) {
  if (batch_) handler_.on_batch_end();
  batch_ = false;
  if (closed_) return;
  ++report_.counters.losses;
  from_.reset();
  handler_.on_input_lost(reason);
}

void UdpInput::tick(Time now) {
  told_stale_ = false;
  hinted_ = false;
  drop_old_offers(now);
  if (!from_) return;
  tell(LinkHeaderType::alive, session_);
  if (!silence_.tick(now)) return;
  drain();  // this end may not have been scheduled: see what has come
  if (!from_ || !silence_.still()) return;
  ++report_.counters.silences;
  tell(LinkHeaderType::refuse, session_, Refusal::unknown_session);
  lose(kSilent);
}

void UdpInput::drop_old_offers(Time now) {
  for (auto i = offers_.begin(); i != offers_.end();) {
    i = now - i->second.since > settings_.timing.handshake() ? offers_.erase(i) : std::next(i);
  }
}

void UdpInput::tell(LinkHeaderType type, Session& session, Refusal refusal) {
  LinkHeader header = admission_.header(type, refusal);
  header.session = session.number;
  std::array<std::uint8_t, kLinkHeaderSize + kSealSize> bytes;
  store_header(bytes.data(), header);
  if (session.sealer) session.sealer->seal(bytes.data(), kLinkHeaderSize);
  send({bytes.data(), session.sealer ? bytes.size() : kLinkHeaderSize}, session.address);
}

void UdpInput::send_tagged(wire::ByteView message, const Nonce& asker, std::uint8_t to, const UdpAddress& address) {
  if (!settings_.self.key) return send(message, address);
  std::vector<std::uint8_t> bytes(message.begin(), message.end());
  const Tag tag = settings_.self.key->tag(message, asker, to);
  bytes.insert(bytes.end(), tag.begin(), tag.end());
  send({bytes.data(), bytes.size()}, address);
}

void UdpInput::send(wire::ByteView datagram, const UdpAddress& to) {
  if (closed_) return;
  // What the kernel does not take is lost, as on the wire: everything told is told again.
  ::sendto(socket_.native_handle(), datagram.data, datagram.size, MSG_DONTWAIT | MSG_NOSIGNAL, to.data(),
           static_cast<socklen_t>(to.size()));
}

}  // namespace limb_ring::link
