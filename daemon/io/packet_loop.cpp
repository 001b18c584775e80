#include "io/packet_loop.h"

#include <sched.h>
#include <sys/epoll.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <utility>

#include "io/unique_fd.h"

namespace limb_ring::event_loop {

bool YieldTimes::due(Time now, bool often) {
  if (!alone(now)) return false;
  const std::int64_t period = now.time_since_epoch() / kPeriod;
  const bool first = std::exchange(period_, period) != period;
  if (first) last_useful_ = now;
  if (!often) return first;
  return now - last_useful_ < kPatience && now.time_since_epoch() % kPeriod >= kSleepFor;
}

void YieldTimes::came_back(Time from, Time to) {
  if (to - from <= kLongestRound) return;
  const bool again = from - pause_ends_ < pause_;  // the last pause was not long ago
  pause_ = again ? std::min(2 * pause_, kLongestPause) : kFirstPause;
  pause_ends_ = to + pause_;
}

void CoreSharing::begin() {
  cpu_set_t cores;
  one_core_ = ::sched_getaffinity(0, sizeof cores, &cores) == 0 && CPU_COUNT(&cores) == 1;
  ours_ = ::sched_getscheduler(0) == SCHED_OTHER;
}

void CoreSharing::end() {
  be_batch(false);
  have_run_ = false;
}

void CoreSharing::let_others_run(YieldTimes::Time now, bool answer_due) {
  be_batch(times_.alone(now));
  if (!times_.due(now, one_core_ && !answer_due)) return;
  ::sched_yield();
  times_.came_back(now, std::chrono::steady_clock::now());
  have_run_ = true;
}

void CoreSharing::after_turn(YieldTimes::Time now, bool any) {
  if (std::exchange(have_run_, false) && any) times_.was_useful(now);
}

// If it is refused, the daemon stays an ordinary one, and is interrupted by those it wakes.
void CoreSharing::be_batch(bool batch) {
  if (!ours_ || batch == batch_) return;
  batch_ = batch;
  const sched_param ordinary{};
  ::sched_setscheduler(0, batch ? SCHED_BATCH : SCHED_OTHER, &ordinary);
}

namespace {

constexpr int kMostEvents = 32;
/// Packets pass once something has come so many times in a row, each within kColdPeriod of the last. Fewer are not
/// worth run_hot(): the beacons of a quiet ring come in handfuls.
constexpr unsigned kTraffic = 8;

int make_set() {
  const int set = ::epoll_create1(EPOLL_CLOEXEC);
  if (set < 0) process::throw_errno("cannot make an epoll set");
  return set;
}

}  // namespace

boost::asio::execution_context::id PacketLoop::id;

PacketLoop& PacketLoop::of(boost::asio::io_context& io) { return boost::asio::use_service<PacketLoop>(io); }

PacketLoop::PacketLoop(boost::asio::execution_context& io)
    : service(io),
      io_(static_cast<boost::asio::io_context&>(io)),
      set_(make_set()),
      asios_(io_),
      cold_timer_(make_timer()) {
  epoll_event event{};
  event.events = EPOLLIN | EPOLLET;
  if (::epoll_ctl(set_.get(), EPOLL_CTL_ADD, cold_timer_.get(), &event) != 0)
    process::throw_errno("cannot wait for a timer");
}

void PacketLoop::shutdown() {
  take_from_asio();
  set_.reset();
  again_.clear();
  stopped_.clear();
  at_turn_end_.clear();
}

// ---- watches ------------------------------------------------------------------------------

void PacketLoop::add(const std::shared_ptr<Watch::State>& watch) {
  watch->loop = this;
  change(watch, EPOLL_CTL_ADD);
  ++watches_;
  let_asio_wait();
}

void PacketLoop::change(const std::shared_ptr<Watch::State>& watch, int operation) {
  epoll_event event{};
  event.events = watch->events | (watch->trigger == Watch::Trigger::edge ? EPOLLET : 0u);
  event.data.ptr = watch.get();
  if (::epoll_ctl(set_.get(), operation, watch->fd, &event) == 0) return;
  watch->loop = nullptr;
  process::throw_errno("cannot wait for a descriptor");
}

void PacketLoop::remove(std::shared_ptr<Watch::State> watch) {
  watch->loop = nullptr;
  if (last_found_ == watch.get()) last_found_ = nullptr;
  if (!set_.valid()) return;
  ::epoll_ctl(set_.get(), EPOLL_CTL_DEL, watch->fd, nullptr);
  --watches_;
  if (watches_ == 0) take_from_asio();  // nothing to wait for: io_context::run() may return
  if (in_turn_) stopped_.push_back(std::move(watch));
}

void PacketLoop::call_later(const std::shared_ptr<Watch::State>& watch) {
  again_.push_back(watch);
  finish_soon();
}

// ---- turns --------------------------------------------------------------------------------

void PacketLoop::at_turn_end(std::function<void()> call) {
  at_turn_end_.push_back(std::move(call));
  finish_soon();
}

// Outside of a turn nothing else is sure to run what waits, so a call is posted that does.
void PacketLoop::finish_soon() {
  if (in_turn_ || running_ || std::exchange(posted_, true)) return;
  boost::asio::post(io_, [this] {
    posted_ = false;
    catch_up();
  });
}

bool PacketLoop::turn(bool may_sleep) {
  if (sharing_.have_run() && look_first()) return true;
  asked_ = true;
  epoll_event ready[kMostEvents];
  const int count = ::epoll_wait(set_.get(), ready, kMostEvents, may_sleep ? -1 : 0);
  bool any = false;
  in_turn_ = true;
  call_those_again();
  for (int i = 0; i < count; ++i) {
    auto* watch = static_cast<Watch::State*>(ready[i].data.ptr);
    if (watch == nullptr) {
      cold_due_ = true;
      continue;
    }
    any = true;
    if (watch->loop != nullptr) watch->on_ready(ready[i].events);
  }
  end_turn();
  return any;
}

// Others of this core have run, so most likely there is something where packets have come last. If there is, the
// kernel need not be asked; it is in every second turn, for all else.
bool PacketLoop::look_first() {
  if (!std::exchange(asked_, false) || last_found_ == nullptr) return false;
  const Watch::State& watch = *std::exchange(last_found_, nullptr);
  in_turn_ = true;
  watch.on_ready(0);
  end_turn();
  return last_found_ != nullptr;
}

void PacketLoop::catch_up() {
  in_turn_ = true;
  call_those_again();
  end_turn();
}

void PacketLoop::call_those_again() {
  called_again_.swap(again_);
  for (const auto& watch : called_again_) {
    watch->again = false;
    if (watch->loop != nullptr) watch->on_ready(0);
  }
  called_again_.clear();
}

// A call may add another one to at_turn_end_.
void PacketLoop::end_turn() {
  for (std::size_t i = 0; i < at_turn_end_.size(); ++i) {
    const auto call = std::move(at_turn_end_[i]);
    call();
  }
  at_turn_end_.clear();
  stopped_.clear();
  in_turn_ = false;
  ++turns_;
  if (has_work()) finish_soon();
}

// ---- running ------------------------------------------------------------------------------

void PacketLoop::run(std::chrono::nanoseconds spin) {
  running_ = true;
  while (!io_.stopped()) {
    if (hot_) {
      run_hot(spin);
    } else if (has_work()) {
      catch_up();
      io_.poll();  // there may be work in every turn, and all else has its turns, too
    } else {
      io_.run_one();  // nothing passes: whatever comes first
    }
  }
  running_ = false;
}

// For each wait with a time-out the kernel sets a timer, which on a virtual machine costs more than all else. One timer
// that ticks all the time is cheap.
void PacketLoop::run_hot(std::chrono::nanoseconds spin) {
  take_from_asio();
  set_timer(cold_timer_.get(), 0, kQuietPeriod, kQuietPeriod);
  sharing_.begin();
  Clock::time_point last_packet = Clock::now();
  bool packets = true;  // since the last tick
  while (!io_.stopped()) {
    const bool spins = spin.count() != 0 && Clock::now() - last_packet < spin;
    const bool any = turn(!spins && !sharing_.have_run() && !has_work());
    const Clock::time_point now = Clock::now();
    sharing_.after_turn(now, any);
    poll_asio_when_due(now);
    const bool answer_due = std::exchange(answer_due_, false);
    if (any) {
      packets = true;
      last_packet = now;
      if (spin.count() == 0 && !has_work()) sharing_.let_others_run(now, answer_due);
    }
    if (!std::exchange(cold_due_, false)) continue;
    tick_again(cold_timer_.get());
    if (!std::exchange(packets, false) && !has_work()) break;
  }
  sharing_.end();
  set_timer(cold_timer_.get(), 0, {}, {});
  hot_ = false;
  let_asio_wait();
}

void PacketLoop::poll_asio_when_due(Clock::time_point now) {
  if (now - last_polled_ < kColdPeriod) return;
  last_polled_ = now;
  io_.poll();
}

void PacketLoop::let_asio_wait() {
  if (asio_waits_ || hot_ || watches_ == 0) return;
  asio_waits_ = true;
  if (!asios_.is_open()) asios_.assign(set_.get());
  asios_.async_wait(boost::asio::posix::stream_descriptor::wait_read, [this](const boost::system::error_code& error) {
    if (error) return;  // cancelled by take_from_asio()
    asio_waits_ = false;
    turn(false);
    const Clock::time_point now = Clock::now();
    in_a_row_ = now - last_ready_ < kColdPeriod ? in_a_row_ + 1 : 0;
    hot_ = running_ && in_a_row_ >= kTraffic;
    last_ready_ = now;
    let_asio_wait();
  });
}

// While the set is itself in Asio's set, it costs time at every packet.
void PacketLoop::take_from_asio() {
  if (asios_.is_open()) asios_.release();
  asio_waits_ = false;
}

PacketTimer::PacketTimer(boost::asio::io_context& io, std::function<void()> on_time)
    : timer_(make_timer()), watch_(io, timer_.get(), EPOLLIN, [call = std::move(on_time)](std::uint32_t) { call(); }) {}

// At least 1 ns: 0 would disarm the timer.
void PacketTimer::expires_at(std::chrono::steady_clock::time_point when) {
  const std::chrono::nanoseconds at =
      std::max(std::chrono::nanoseconds(1), std::chrono::nanoseconds(when.time_since_epoch()));
  set_timer(timer_.get(), TFD_TIMER_ABSTIME, at, {});
}

void PacketTimer::cancel() { set_timer(timer_.get(), 0, {}, {}); }

Watch::Watch(boost::asio::io_context& io, int fd, std::uint32_t events, OnReady on_ready, Trigger trigger)
    : state_(std::make_shared<State>()) {
  state_->fd = fd;
  state_->trigger = trigger;
  state_->events = events;
  state_->on_ready = std::move(on_ready);
  PacketLoop::of(io).add(state_);
}

Watch& Watch::operator=(Watch&& other) noexcept {
  if (this != &other) stop();
  state_ = std::move(other.state_);
  return *this;
}

void Watch::set_events(std::uint32_t events) {
  if (state_->events == events) return;
  state_->events = events;
  state_->loop->change(state_, EPOLL_CTL_MOD);
}

void Watch::call_again() {
  if (std::exchange(state_->again, true)) return;
  state_->loop->call_later(state_);
}

void Watch::found_packets() { state_->loop->found_packets(*state_); }

void Watch::stop() {
  if (!state_ || state_->loop == nullptr) return;
  state_->loop->remove(std::move(state_));
}

}  // namespace limb_ring::event_loop
