#include "node/session.h"

#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "io/unix_socket.h"

namespace limb_ring::host {
namespace {

using process::would_block;

/// Read in one turn of the event loop: enough for some full packets, little enough that a client
/// that floods us does not hold up the ring.
constexpr std::size_t kReadSize = 8 * 1024;

std::string reason_of(SessionOwner::End how) {
  switch (how) {
    case SessionOwner::End::closed:
      return "";
    case SessionOwner::End::garbage:
      return "this is not a message of the host port";
    case SessionOwner::End::never_greeted:
      return "no greeting came within 2 s";
    case SessionOwner::End::too_slow:
      return "the client does not read what is sent to it";
  }
  return "";
}

/// SO_RCVTIMEO in place of poll(): a poll() with a time-out makes the kernel set a timer, which on a virtual machine
/// costs more than all else.
void limit_wait(int socket, std::chrono::microseconds patience) {
  const timeval limit{0, static_cast<suseconds_t>(patience.count())};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
}

}  // namespace

Session::Session(boost::asio::io_context& io, process::UniqueFd socket, ClientInfo info, SessionOwner& owner)
    : loop_(event_loop::PacketLoop::of(io)),
      socket_(std::move(socket)),
      greeting_timer_(io),
      gather_timer_(io),
      info_(info),
      owner_(&owner),
      watch_(io, socket_.get(), EPOLLIN | EPOLLRDHUP, [this](std::uint32_t events) { on_ready(events); }) {}

void Session::start() { wait_for_greeting(); }

void Session::wait_for_greeting() {
  greeting_timer_.expires_after(kGreetingDeadline);
  greeting_timer_.async_wait([self = shared_from_this()](boost::system::error_code error) {
    if (error || self->attached_) return;
    if (self->frozen_) return self->wait_for_greeting();  // a greeting may be waiting unread
    self->fail(SessionOwner::End::never_greeted);
  });
}

void Session::greeted() {
  greeted_ = true;
  greeting_timer_.cancel();
}

void Session::attach(const ClientInfo& info, TurnKeeper* turns) {
  attached_ = true;
  info_ = info;
  greeting_timer_.cancel();
  if (!info.lockstep) return;
  turn_.emplace(*turns);
  limit_wait(socket_.get(), kPatience);
  watch_.set_events(input_events());
}

void Session::asks() {
  ++under_way_;
  last_ = std::chrono::steady_clock::now();
}

void Session::is_told() {
  if (under_way_ != 0) --under_way_;
  last_ = std::chrono::steady_clock::now();
}

std::chrono::nanoseconds Session::idle_for() const {
  if (under_way_ != 0 || observes_ || info_.role == Role::cpu) return {};
  return std::chrono::steady_clock::now() - last_;
}

// ---- lockstep -----------------------------------------------------------------------------

void Session::begin_turn(std::chrono::nanoseconds now) {
  turn_->begin();
  client::append(out_.to_append(), client::Turn{now});
  if (!flush_under_way_) flush();
}

void Session::end_turn(std::chrono::nanoseconds until) {
  const bool was_awaited = turn_->is_awaited();
  turn_->end(until);
  if (!was_awaited) watch_.set_events(input_events());
  if (!out_.empty()) turn_->comes_within(kGatherResults);  // results that wait go out with it
}

bool Session::await_message() {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  const ssize_t got = ::recv(socket_.get(), in_.space(kReadSize), kReadSize, 0);
  if (got < 0 && would_block(errno)) return false;
  take(got);
  return true;
}

void Session::wait_no_more() {
  turn_->await_no_more();
  watch_.set_events(input_events());
}

std::uint32_t Session::input_events() const {
  const bool by_await = turn_ && turn_->is_awaited();
  return by_await ? EPOLLRDHUP : EPOLLIN | EPOLLRDHUP;
}

void Session::on_ready(std::uint32_t events) {
  const auto self = shared_from_this();  // the owner may let go of us in its call
  if ((events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) != 0) ending_ = true;
  if (frozen_) return;
  if ((events & EPOLLOUT) != 0) flush();
  const bool is_awaited = turn_ && turn_->is_on() && turn_->is_awaited();
  if (open() && !is_awaited && !has_said_enough()) read();
}

bool Session::has_said_enough() const { return greeted_ && !attached_ && in_.view().size >= client::kMaxSizeToDaemon; }

void Session::read() {
  if (std::exchange(put_off_, false)) take_frames();
  if (open() && !put_off_) take(::recv(socket_.get(), in_.space(kReadSize), kReadSize, MSG_DONTWAIT));
}

void Session::put_off_the_rest() {
  put_off_ = true;
  watch_.call_again();
}

void Session::thaw() {
  frozen_ = false;
  if (open() && std::exchange(flush_under_way_, false)) flush();
  if (open()) watch_.call_again();
}

// epoll reports the end of the connection only once. What came before may take several reads, hence call_again().
void Session::take(ssize_t got) {
  const bool ended = got == 0 || (got < 0 && !would_block(errno));
  if (got > 0) in_.added(static_cast<std::size_t>(got));
  take_frames();
  if (!open() || put_off_) return;
  if (ended) return fail(SessionOwner::End::closed);
  if (got > 0 && (ending_ || static_cast<std::size_t>(got) == kReadSize)) watch_.call_again();
}

void Session::take_frames() {
  while (open() && (attached_ || !greeted_)) {
    const client::FrameParse parse = client::parse_frame(in_.view(), client::kMaxSizeToDaemon);
    if (parse.status == client::FrameParse::Status::incomplete) return;
    const bool frame = parse.status == client::FrameParse::Status::frame;
    const auto message = frame ? client::decode_to_daemon(parse.frame) : std::nullopt;
    if (!message) return fail(SessionOwner::End::garbage);
    const bool greeting = std::holds_alternative<client::Greeting>(*message);
    const bool ends_no_turn = std::holds_alternative<client::Waiting>(*message) && !(turn_ && turn_->is_on());
    if (greeting == attached_ || ends_no_turn) return fail(SessionOwner::End::garbage);
    owner_->on_message(*this, *message);
    in_.used(parse.consumed);
    if (open() && !turn_ && owner_->has_asked_enough()) return put_off_the_rest();
  }
}

bool Session::keeps_limit() {
  if (!out_.is_over_limit()) return true;
  fail(SessionOwner::End::too_slow);
  return false;
}

void Session::put_result(const Result& result) {
  if (!info_.results_may_wait) return put(result);
  if (!append(result)) return;
  if (!turn_) return flush_within(kGatherResults);
  turn_->comes_within(kGatherResults);
}

bool Session::put_observed(const Observed& observed) {
  if (!open()) return true;
  if (out_.size() + observed.json.size() > kMaxQueuedForObserved) {
    ++observed_lost_;
    return false;
  }
  tell_observed_lost();
  put(observed);
  return true;
}

bool Session::put_captured(const client::CapturedView& packet) {
  if (!open()) return true;
  if (out_.size() + packet.packet.bytes.size > kMaxQueuedForCaptured) return false;
  client::append(out_.to_append(), packet);
  if (!turn_ && out_.size() < kCapturedLot) {
    flush_within(kGatherCaptured);
  } else {
    flush_soon();
  }
  return true;
}

void Session::tell_observed_lost() {
  const std::uint64_t lost = std::exchange(observed_lost_, 0);
  if (lost > 0) put(ObservedLost{lost});
}

void Session::flush_soon() {
  if (turn_) return turn_->tell_news();
  if (std::exchange(flush_under_way_, true)) return;
  loop_.at_turn_end([self = shared_from_this()] { self->flush(); });
}

void Session::flush_within(std::chrono::milliseconds time) {
  const bool gathering = gathering_for_.count() != 0;
  if (flush_under_way_ || (gathering && gathering_for_ <= time)) return;
  const auto by = std::chrono::steady_clock::now() + time;
  gathering_for_ = time;
  gather_timer_.expires_at(gathering ? std::min(gather_timer_.expiry(), by) : by);
  gather_timer_.async_wait([self = shared_from_this()](boost::system::error_code error) {
    if (error) return;  // it was set again, or the session has ended
    self->gathering_for_ = std::chrono::milliseconds{0};
    self->flush_soon();
  });
}

void Session::flush() {
  if (frozen_) return;  // thaw() does it
  flush_under_way_ = false;
  if (!open()) return;
  watch_.set_events(input_events());
  const int error = write_now();
  loop_.expect_answer();
  if (error != 0 && !would_block(error)) return fail(SessionOwner::End::closed);
  if (!out_.empty()) return wait_writable();
  tell_observed_lost();
}

int Session::write_now() {
  while (!out_.empty()) {
    const ssize_t went = ::send(socket_.get(), out_.view().data, out_.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (went < 0 && errno != EINTR) return errno;
    if (went > 0) out_.remove(static_cast<std::size_t>(went));
  }
  return 0;
}

void Session::wait_writable() {
  flush_under_way_ = true;
  watch_.set_events(input_events() | EPOLLOUT);
}

bool Session::hung_up() const {
  pollfd entry{socket_.get(), POLLIN, 0};
  return ::poll(&entry, 1, 0) > 0 && (entry.revents & (POLLHUP | POLLERR)) != 0;
}

void Session::end(const std::string& reason) {
  if (!open()) return;
  owner_ = nullptr;
  if (!reason.empty()) client::append(out_.to_append(), client::Refused{reason});
  write_now();
  greeting_timer_.cancel();
  gather_timer_.cancel();
  watch_.stop();
  socket_.reset();
}

void Session::fail(SessionOwner::End how) {
  if (!open()) return;
  SessionOwner& owner = *owner_;
  ended_by_client_ = how == SessionOwner::End::closed;
  end(reason_of(how));
  owner.on_end(*this, how);
}

}  // namespace limb_ring::host
