#include "io/udp_line.h"

#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <utility>

#include "io/unix_line.h"

namespace limb_ring::link {
namespace {

/// No events once a session is accepted: nothing that comes back is urgent, and epoll tells of errors in any case.
constexpr std::uint32_t kForErrors = 0;

/// Room for an `accept` of a keyed line, and for 8 bytes more: a longer datagram is then seen to be too long.
constexpr std::size_t kLongestAnswer = kLinkHeaderSize + sizeof(Nonce) + kTagSize + 8;

}  // namespace

UdpDownstream::UdpDownstream(boost::asio::io_context& io, UdpAddress address, const Identity& self, Peer peer,
                             Owner& owner, OutputCounters& counters)
    : io_(io),
      address_(std::move(address)),
      self_(self),
      peer_(peer),
      owner_(&owner),
      counters_(counters),
      socket_(io),
      batch_(self, counters),
      session_(std::uint64_t{fresh_nonce()} << 32) {
  if (self_.key) asker_ = fresh_long_nonce();
}

bool UdpDownstream::start() {
  socket_ = connect_udp(io_, address_);
  if (!socket_.is_open() || !tell(LinkHeaderType::connect)) return false;
  watch_ = event_loop::Watch(io_, socket_.native_handle(), EPOLLIN, [this](std::uint32_t events) { on_ready(events); });
  return true;
}

void UdpDownstream::on_ready(std::uint32_t events) {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  if (events != EPOLLOUT) read();
  if (open() && !failed_ && !backlog_.empty()) send_backlog();
}

void UdpDownstream::read() {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  std::array<std::uint8_t, kLongestAnswer> bytes;
  for (int reads = 0; open() && !failed_; ++reads) {
    if (reads == kMostHeaders) return watch_.call_again();
    const auto got = receive_now(socket_.native_handle(), bytes.data(), bytes.size());
    if (got < 0 && would_block(errno)) return;
    if (got < 0 && sealer_) return;  // "port unreachable" proves nothing: the silence will tell
    if (got < 0) {
      failed_ = true;
      return owner_->on_ended(peer_.candidate, "nobody listens there");
    }
    take({bytes.data(), static_cast<std::size_t>(got)});
  }
}

void UdpDownstream::take(wire::ByteView datagram) {
  const auto header = parse_header(datagram);
  if (!header || session_nonce(header->session) != session_nonce(session_)) return;
  if (!self_.key || is_authentic(*header, datagram)) take_header(*header);
}

bool UdpDownstream::is_authentic(const LinkHeader& header, wire::ByteView datagram) {
  if (header.type == LinkHeaderType::refuse && datagram.size == kLinkHeaderSize) {
    if (!accepted_) owner_->on_hint(peer_.candidate, header);
    return false;
  }
  return accepted_ ? is_of_session(datagram) : is_of_handshake(header, datagram);
}

bool UdpDownstream::is_of_handshake(const LinkHeader& header, wire::ByteView datagram) {
  const bool accepts = header.type == LinkHeaderType::accept;
  const std::size_t signed_size = kLinkHeaderSize + (accepts ? answerer_.size() : 0);
  if (datagram.size != signed_size + kTagSize) {
    ++counters_.datagrams_truncated;
    return false;
  }
  if (header.sender != peer_.id ||
      !self_.key->check(datagram.first(signed_size), asker_, self_.id, datagram.data + signed_size)) {
    ++counters_.datagrams_forged;
    return false;
  }
  if (accepts) std::copy_n(datagram.data + kLinkHeaderSize, answerer_.size(), answerer_.begin());
  return true;
}

bool UdpDownstream::is_of_session(wire::ByteView datagram) {
  if (datagram.size < kLinkHeaderSize + kSealSize) {
    ++counters_.datagrams_truncated;
    return false;
  }
  const Opener::Verdict verdict = opener_->open(datagram);
  count(verdict, counters_);
  return verdict == Opener::Verdict::good;
}

void UdpDownstream::take_header(const LinkHeader& header) {
  if (header.type == LinkHeaderType::accept) return accept(header);
  if (accepted_ && header.session != session_) return;
  if (header.type == LinkHeaderType::refuse) return owner_->on_refused(peer_.candidate, header);
  if (header.type == LinkHeaderType::alive) owner_->on_heard(peer_.candidate);
}

void UdpDownstream::accept(const LinkHeader& header) {
  if (accepted_ || header.ring != self_.ring) return;
  accepted_ = true;
  session_ = header.session;
  if (self_.key) {
    const SessionKeys keys = self_.key->session({asker_, answerer_, session_, self_.id, peer_.id});
    sealer_.emplace(keys.forward);
    opener_.emplace(keys.backward);
  }
  batch_.start_session(session_, sealer_ ? &*sealer_ : nullptr);
  watch_.set_events(kForErrors);
  owner_->on_accepted(peer_.candidate);
}

void UdpDownstream::write(wire::ByteView slices) {
  if (failed_ || !open()) {
    counters_.discarded += slices.size;
    return;
  }
  const std::size_t taken = backlog_.empty() ? send(slices) : 0;
  if (failed_ || taken == slices.size) return;
  if (backlog_.empty()) {
    ++counters_.blocked;
    watch_.set_events(kForErrors | EPOLLOUT);
  }
  if (!backlog_.add(slices.from(taken))) fail("too much waits for it");
}

bool UdpDownstream::hold_back(wire::ByteView slice) {
  return !failed_ && open() && backlog_.empty() && batch_.hold_back(slice);
}

std::size_t UdpDownstream::send(wire::ByteView slices) {
  const UdpBatch::Result result = batch_.send(socket_.native_handle(), slices);
  if (result.status == UdpBatch::Status::gone) fail("nobody listens there");
  return result.taken;
}

void UdpDownstream::send_backlog() {
  backlog_.remove(send(backlog_.view()));
  if (failed_ || !backlog_.empty()) return;
  watch_.set_events(kForErrors);
  owner_->on_drained(peer_.candidate);
}

void UdpDownstream::ask_again() {
  if (!accepted_ && !failed_ && !tell(LinkHeaderType::connect)) fail("nobody listens there");
}

bool UdpDownstream::tell(LinkHeaderType type) {
  LinkHeader header;
  header.type = self_.key && type == LinkHeaderType::connect ? LinkHeaderType::connect_keyed : type;
  header.ring = self_.ring;
  header.sender = self_.id;
  header.session = session_;
  std::array<std::uint8_t, kKeyedConnectSize> bytes;
  std::size_t size = kLinkHeaderSize;
  store_header(bytes.data(), header);
  if (type == LinkHeaderType::connect) {
    size = kConnectSize;
    store_agreement(bytes.data() + kLinkHeaderSize, self_.agreement);
  }
  if (header.type == LinkHeaderType::connect_keyed) {
    size = kKeyedConnectSize;
    std::copy(asker_.begin(), asker_.end(), bytes.begin() + kConnectSize);
    const Tag tag = self_.key->tag({bytes.data(), size - kTagSize}, asker_, peer_.id);
    std::copy(tag.begin(), tag.end(), bytes.end() - kTagSize);
  } else if (sealer_) {
    sealer_->seal(bytes.data(), size);
    size += kSealSize;
  }
  const auto sent = send_now(socket_.native_handle(), {bytes.data(), size});
  return sent >= 0 || would_block(errno);
}

void UdpDownstream::fail(std::string reason) {
  failed_ = true;
  boost::asio::post(io_, [self = shared_from_this(), reason = std::move(reason)] {
    if (self->open()) self->owner_->on_ended(self->peer_.candidate, reason);
  });
}

void UdpDownstream::close() {
  if (open() && socket_.is_open() && accepted_) tell(LinkHeaderType::bye);
  sever();
}

void UdpDownstream::sever() {
  if (!open()) return;
  owner_ = nullptr;
  counters_.discarded += backlog_.size();
  watch_.stop();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

namespace {

constexpr std::size_t kReadSize = 64 * 1024;
/// Reads in a row at most, so that the timers get their turn under any load.
constexpr int kReadsPerTurn = 64;
/// Runs of datagrams that can have waited in the socket (kSocketBuffer).
constexpr std::size_t kMostWaiting = 4096;

struct Run {
  std::vector<std::uint8_t> bytes;
  std::size_t segment;
  UdpAddress sender;
};

template <class Visit>
void each_datagram(wire::ByteView run, std::size_t segment, Visit visit) {
  do {
    const std::size_t one = std::min(segment, run.size);
    visit(run.first(one));
    run = run.from(one);
  } while (!run.empty());
}

}  // namespace

UdpInput::UdpInput(boost::asio::io_context& io, const InputSettings& settings, InputHandler& handler,
                   InputReport& report, Upstream& upstream)
    : io_(io),
      report_(report),
      socket_(listen_udp(io, settings.endpoint)),
      datagrams_(settings, *this, handler, report, upstream,
                 [this](wire::ByteView datagram, const UdpAddress& to) { send(datagram, to); }),
      buffer_(kReadSize),
      suspension_(settings.several_hosts, settings.timing.silence),
      ticker_(io, settings.timing.idle, [this](Time now) { tick(now); }) {}

void UdpInput::close() {
  if (datagrams_.closed()) return;
  datagrams_.close();
  ticker_.stop();
  watch_.stop();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

void UdpInput::start() {
  const auto on_ready = [this](std::uint32_t) {
    const auto self = shared_from_this();  // the handler may close the input
    read();
  };
  watch_ = event_loop::Watch(io_, socket_.native_handle(), EPOLLIN, on_ready, event_loop::Watch::Trigger::level);
}

void UdpInput::read() {
  const Time now = Clock::now();
  if (suspension_.noticed() && datagrams_.from()) datagrams_.given_up();
  if (datagrams_.stood_still(now)) return read_after_standstill(now);
  bool found = read_run(now);
  for (int reads = 1; found && reads < kReadsPerTurn && read_again_.wanted(); ++reads) {
    found = read_run(now);
    read_again_.found(found);
  }
  datagrams_.end_batch();
}

// The neighbour may have given this end up meanwhile. Its bye is behind all that waits, or found no room there. What
// waits is old then: packets have taken the way past this node since, and their copies would come behind them.
void UdpInput::read_after_standstill(Time now) {
  bool given_up = dropped_datagrams(socket_.native_handle()) != dropped_;
  std::vector<Run> waiting;
  while (waiting.size() < kMostWaiting) {
    UdpAddress sender;
    const UdpRead read = receive_run(socket_.native_handle(), buffer_.data(), buffer_.size(), sender);
    if (read.size < 0) break;
    const wire::ByteView run{buffer_.data(), static_cast<std::size_t>(read.size)};
    waiting.push_back({{run.begin(), run.end()}, read.segment, sender});
    each_datagram(run, read.segment, [&](wire::ByteView one) { given_up = given_up || datagrams_.is_bye(one); });
  }
  if (given_up || waiting.size() == kMostWaiting) datagrams_.given_up();
  for (const Run& run : waiting) take_run({run.bytes.data(), run.bytes.size()}, run.segment, run.sender, now);
  datagrams_.end_batch();
}

void UdpInput::drain() {
  const Time now = Clock::now();
  int reads = 0;
  while (reads < kReadsPerTurn && read_run(now)) ++reads;
  datagrams_.end_batch();
}

bool UdpInput::read_run(Time now) {
  if (datagrams_.closed()) return false;
  UdpAddress sender;
  const UdpRead read = receive_run(socket_.native_handle(), buffer_.data(), buffer_.size(), sender);
  if (read.size < 0) return false;
  watch_.found_packets();
  take_run({buffer_.data(), static_cast<std::size_t>(read.size)}, read.segment, sender, now);
  return true;
}

void UdpInput::take_run(wire::ByteView run, std::size_t segment, const UdpAddress& sender, Time now) {
  ++report_.counters.reads;
  report_.counters.bytes += run.size;
  each_datagram(run, segment, [&](wire::ByteView one) { datagrams_.take(one, sender, now); });
}

void UdpInput::tick(Time now) {
  if (datagrams_.stood_still(now)) read_after_standstill(now);
  dropped_ = dropped_datagrams(socket_.native_handle());
  if (!datagrams_.tick(now)) return;
  drain();  // this end may not have been scheduled: see what has come
  datagrams_.lose_if_silent();
}

void UdpInput::send(wire::ByteView datagram, const UdpAddress& to) {
  // What the kernel does not take is lost, as on the wire: everything told is told again.
  ::sendto(socket_.native_handle(), datagram.data, datagram.size, MSG_DONTWAIT | MSG_NOSIGNAL, to.data(),
           static_cast<socklen_t>(to.size()));
}

}  // namespace limb_ring::link
