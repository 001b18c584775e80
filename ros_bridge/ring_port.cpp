#include "ros_bridge/ring_port.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr auto kRetry = 200ms;        // between tries to connect
constexpr auto kLongestWait = 100ms;  // so that alive() is passed on
constexpr auto kLook = 10ms;          // at what nobody tells of
constexpr auto kClockPeriod = 1ms;    // of a virtual ring's time, as it is told
constexpr std::size_t kPostLimit = 1024;
constexpr int kMessagesAtOnce = 256;  // then posted work and ticks have their turn

int make_wake() {
  const int fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  return fd;
}

void ring_bell(int fd) {
  const std::uint64_t one = 1;
  // A full counter means that the bell is ringing already.
  if (write(fd, &one, sizeof one) < 0) return;
}

void quiet_bell(int fd) {
  std::uint64_t count = 0;
  if (read(fd, &count, sizeof count) < 0) return;
}

Result cancelled(std::uint32_t token, const std::string& reason) {
  Result result;
  result.token = token;
  result.outcome = Outcome::cancelled;
  result.reason = reason;
  return result;
}

}  // namespace

RingPort::RingPort(ConnectOptions options) : options_(std::move(options)), wake_(make_wake()) {}

RingPort::~RingPort() {
  stop();
  close(wake_);
}

RingPort::TimeGoesOn::TimeGoesOn(RingPort& port) : port_(port) {
  ++port_.letting_go_;
  ring_bell(port_.wake_);
}

void RingPort::start() {
  thread_ = std::thread([this] { run(); });
}

void RingPort::stop() {
  stopping_ = true;
  ring_bell(wake_);
  if (thread_.joinable()) thread_.join();
}

bool RingPort::post(std::function<void()> work) {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (posted_.size() >= kPostLimit) return false;
    posted_.push_back(std::move(work));
  }
  ring_bell(wake_);
  return true;
}

void RingPort::run() {
  while (!stopping_) {
    if (!port_) try_connect();
    wait_for_something();
    notice_time();
    take_messages();
    run_posted();
    ticks_.run(now());
    if (post_alive_.exchange(false) && port_ && !in_lockstep()) port_->alive();
  }
  port_.reset();
}

void RingPort::try_connect() {
  if (Clock::now() < next_try_) return;
  next_try_ = Clock::now() + kRetry;
  try {
    port_.emplace(HostPort::connect(options_));
    told_time_ = port_->now() - kClockPeriod;
    if (in_lockstep()) ticks_.restart(now());
    report("");
  } catch (const HostPortError& error) {
    report(error.what());
  }
}

RingPort::Clock::time_point RingPort::now() const {
  return in_lockstep() ? Clock::time_point(port_->now()) : Clock::now();
}

std::int64_t RingPort::stamp_of(Clock::time_point came) {
  return in_lockstep() ? port_->stamp().count() : wall_clock_.at(came);
}

// Without a connection the stamps stay with the clock that they had: a ring's time and the machine's are decades apart.
void RingPort::notice_time() {
  if (!port_) return;
  if (!in_lockstep()) return ros_clock_.set_ring(RosClock::kMachine);
  ros_clock_.set_ring(port_->now().count());
  if (port_->now() >= told_time_ + kClockPeriod) tell_time();
}

void RingPort::tell_time() {
  if (!time_ || !in_lockstep()) return;
  const auto time = port_->now();
  if (std::exchange(told_time_, time) != time) time_(time);
}

RingPort::Held RingPort::hold_time_until(const std::function<bool()>& condition, std::chrono::milliseconds patience) {
  const auto deadline = Clock::now() + patience;
  while (!condition() && !stopping_) {
    if (letting_go_ != 0) return Held::let_go;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (left <= 0ms) return Held::in_vain;
    pollfd bell{wake_, POLLIN, 0};
    const auto wait = std::min<std::chrono::milliseconds>(left, kLook);
    if (poll(&bell, 1, static_cast<int>(wait.count())) > 0) quiet_bell(wake_);
    run_posted();
  }
  return Held::fulfilled;
}

void RingPort::report(const std::string& problem) {
  if (problem == problem_) return;
  problem_ = problem;
  for (const auto& handler : connection_) handler(problem);
}

RingPort::Clock::time_point RingPort::next_deadline() const {
  auto deadline = now() + kLongestWait;
  if (in_lockstep() && time_) deadline = std::max(now(), Clock::time_point(told_time_ + kClockPeriod));
  deadline = std::min(deadline, ticks_.next_due());
  if (!port_) deadline = std::min(deadline, next_try_);
  return deadline;
}

// In lockstep posted work does not wake this thread: it waits for the next turn, at most 1 ms of ring time later.
void RingPort::wait_for_something() {
  if (in_lockstep()) {
    if (!more_to_take_) message_ = port_->receive(std::max<Clock::duration>(0ns, next_deadline() - now()));
    return;
  }
  pollfd fds[2] = {{wake_, POLLIN, 0}, {port_ ? port_->fd() : -1, POLLIN, 0}};
  const auto wait = more_to_take_ ? 0ns : std::max<Clock::duration>(0ns, next_deadline() - Clock::now());
  const timespec timeout{wait / 1s, (wait % 1s).count()};
  // Interrupted or not: everything is checked below in any case.
  if (ppoll(fds, 2, &timeout, nullptr) < 0) return;
  if (fds[0].revents) quiet_bell(wake_);
}

void RingPort::take_messages() {
  more_to_take_ = false;
  for (int i = 0; port_ && i < kMessagesAtOnce; ++i) {
    auto message = message_ ? std::exchange(message_, std::nullopt) : port_->receive(0ms);
    if (!message) return;
    take(std::move(*message));
  }
  more_to_take_ = port_.has_value();
}

void RingPort::take(Message message) {
  if (auto* packet = std::get_if<Packet>(&message)) {
    if (packet->channel < packets_.size() && packets_[packet->channel]) packets_[packet->channel](*packet);
  } else if (auto* result = std::get_if<Result>(&message)) {
    auto entry = results_.extract(result->token);
    if (entry && entry.mapped()) entry.mapped()(*result);
  } else if (auto* interrupt = std::get_if<Interrupt>(&message)) {
    if (interrupt_) interrupt_(*interrupt);
  } else if (auto* end = std::get_if<Disconnected>(&message)) {
    lost(end->reason);
  }
}

void RingPort::lost(const std::string& reason) {
  const bool was_virtual = in_lockstep();
  port_.reset();
  message_.reset();
  if (was_virtual) ticks_.restart(now());
  more_to_take_ = false;
  next_try_ = Clock::now() + kRetry;
  auto open = std::move(results_);
  results_.clear();
  for (auto& [token, handler] : open)
    if (handler) handler(cancelled(token, reason));
  report("disconnected: " + reason);
}

void RingPort::run_posted() {
  std::deque<std::function<void()>> now;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    now.swap(posted_);
  }
  for (auto& work : now) work();
  auto unsendable = std::move(unsendable_);
  unsendable_.clear();
  for (auto& on_result : unsendable) on_result(cancelled(0, "not connected"));
}

void RingPort::send(const Outgoing& packet, OnResult on_result) {
  if (!port_) {
    // Later, as promised, so that a sender that goes on from its result does not recurse.
    if (on_result) unsendable_.push_back(std::move(on_result));
    ring_bell(wake_);
    return;
  }
  const auto token = port_->send(packet.destination, packet.data, packet.priority, packet.channel);
  results_[token] = std::move(on_result);
}

void PeriodicCalls::add(Duration period, std::optional<Duration> phase, std::function<void()> call, Time now) {
  calls_.push_back({period, phase, std::move(call), {}});
  calls_.back().due = first_due(calls_.back(), now);
}

void PeriodicCalls::restart(Time now) {
  for (Call& call : calls_) call.due = first_due(call, now);
}

PeriodicCalls::Time PeriodicCalls::first_due(const Call& call, Time now) {
  if (!call.phase) return now + call.period;
  const Duration since = now.time_since_epoch() - *call.phase;
  const auto periods = since.count() < 0 ? 0 : since / call.period + 1;
  return Time(periods * call.period + *call.phase);
}

PeriodicCalls::Time PeriodicCalls::next_due() const {
  Time next = Time::max();
  for (const Call& call : calls_) next = std::min(next, call.due);
  return next;
}

void PeriodicCalls::run(Time now) {
  for (Call& call : calls_) {
    if (now < call.due) continue;
    call.call();
    do call.due += call.period;
    while (call.due <= now);
  }
}

}  // namespace limb_ring::bridge
