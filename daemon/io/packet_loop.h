#pragma once

#include <sys/timerfd.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "io/unique_fd.h"
#include "wire/bytes.h"

namespace limb_ring::event_loop {

/// When a daemon that has nothing left to do should let the others of its core run rather than sleep. Time goes in, no
/// clock is read. (ours)
class YieldTimes {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  /// All daemons of a host sleep in the first kSleepFor of each kPeriod of its clock.
  static constexpr Duration kPeriod = std::chrono::milliseconds(100), kSleepFor = std::chrono::milliseconds(1);
  /// If there has been nothing to do afterwards for so long, it is enough for this period.
  static constexpr Duration kPatience = std::chrono::milliseconds(8);
  /// All daemons of a ring have had their turn by then; a program that computes keeps the core for longer.
  static constexpr Duration kLongestRound = std::chrono::milliseconds(1);
  /// If something computes, nobody is let run for so long; twice as long each time it is still there.
  static constexpr Duration kFirstPause = std::chrono::milliseconds(500), kLongestPause = std::chrono::seconds(16);

  /// Whether the core is taken to be the ring's alone.
  bool alone(Time now) const { return now >= pause_ends_; }
  /// Whether to let others run now.
  /// @param often whenever it may be useful; else once a period, to see how long it takes
  bool due(Time now, bool often);
  /// They have run from `from` to `to`.
  void came_back(Time from, Time to);
  /// There was something to do then.
  void was_useful(Time now) { last_useful_ = now; }

 private:
  Time pause_ends_{};
  Duration pause_{};         ///< the last one
  std::int64_t period_ = 0;  ///< that due() was last asked in
  Time last_useful_{};       ///< or when that period began
};

/// How a daemon shares a core with the others of the ring while packets pass. (ours)
///
/// One that hands on a packet and sleeps is put to sleep and woken at every lap, and the one it wakes interrupts it
/// first: three switches a hop instead of one. So while nothing else computes there, a daemon is under SCHED_BATCH,
/// which interrupts nobody. If it may run on one core only, it does not sleep either but lets the others run
/// (sched_yield): when it is its turn again, what they have sent is there. The kernel then gives them their turns in an
/// order that stays. One that sleeps, and is woken by the one before it in the ring, comes right behind that: so all
/// sleep for a moment now and then, and the order becomes the ring's. If it is not, packets wait at some hops until
/// all have had their turn. While packets are few, there is nothing to do after that, and it is given up until the next
/// period. With several cores to choose from, to sleep is best: the kernel looks for a free one when it wakes a
/// process.
///
/// If something else computes on that core, all this would give it a slice at every hop. Letting others run takes
/// too long then; so that is seen, and the daemon is an ordinary one for some time. A process that was not under
/// SCHED_OTHER keeps its policy.
class CoreSharing {
 public:
  /// Packets pass from now on.
  void begin();
  /// No packets pass any more.
  void end();
  /// Lets the others run if that is good now.
  /// @param now steady_clock
  /// @param answer_due a process of this host has been given something, and may answer. To sleep is best then, as its
  ///        answer wakes this one; if all others ran first, it would wait for them.
  void let_others_run(YieldTimes::Time now, bool answer_due);
  /// Others have run since the last turn: this one must not wait.
  bool have_run() const { return have_run_; }
  /// @param any there was something to do in this turn
  void after_turn(YieldTimes::Time now, bool any);

 private:
  void be_batch(bool batch);

  YieldTimes times_;
  bool one_core_ = false;  ///< it may run on one only
  bool ours_ = false;      ///< the policy was SCHED_OTHER, and is ours to change
  bool batch_ = false;     ///< it is SCHED_BATCH
  bool have_run_ = false;
};

class PacketLoop;

/// A descriptor that packets come through, watched by the PacketLoop until stop() or destruction: it stays in the
/// loop's epoll set, so that waiting for it again costs nothing.
class Watch {
 public:
  enum class Trigger : std::uint8_t {
    edge,  ///< calls once for what comes: read until there is nothing left, or ask to be called again
    level  ///< calls in each turn in which there is something
  };
  /// What came: EPOLLIN, EPOLLOUT, EPOLLRDHUP, EPOLLHUP, EPOLLERR; 0 after call_again().
  using OnReady = std::function<void(std::uint32_t events)>;

  Watch() = default;
  /// @param fd stays open longer than this watches it
  /// @param events as epoll_ctl() takes them, without EPOLLET
  /// @throw std::system_error if the kernel takes no more of them, or `fd` cannot be waited for
  Watch(boost::asio::io_context& io, int fd, std::uint32_t events, OnReady on_ready, Trigger trigger = Trigger::edge);
  Watch(Watch&&) noexcept = default;
  Watch& operator=(Watch&& other) noexcept;
  ~Watch() { stop(); }

  /// Waits for these events from now on. @pre watching
  void set_events(std::uint32_t events);
  /// Calls back in the loop's next turn even if nothing comes; the others get their turn before. @pre watching
  void call_again();
  /// Packets have come this way: the loop may look here first, by a call with 0, before it asks the kernel what is
  /// ready. @pre watching
  void found_packets();
  /// No call after this, also not one that is due. May be called from within a call.
  void stop();

 private:
  friend class PacketLoop;
  struct State;
  std::shared_ptr<State> state_;
};

/// The part of an event loop that packets pass through, one for each io_context. Its descriptors stay in an epoll set
/// of its own: a packet costs at most one system call to wait for it, and those that read and write it. Boost.Asio
/// makes one more each time it waits for a descriptor again; it handles what is rare: timers, connections, signals.
/// (ours)
///
/// While nothing passes, Asio waits for the set as for any descriptor. While packets pass, run() waits on the set
/// itself, and lets Asio see to its own every kColdPeriod. A program that calls io_context::run() instead gets the same
/// calls, more slowly.
class PacketLoop final : public boost::asio::execution_context::service {
 public:
  /// While packets pass, Asio's timers and sockets are late by at most this, or by the time between two packets if that
  /// is longer. When packets have just stopped, they are late by at most kQuietPeriod.
  static constexpr std::chrono::milliseconds kColdPeriod{5};
  /// No packets pass once none has come for this.
  static constexpr std::chrono::milliseconds kQuietPeriod{20};

  static boost::asio::execution_context::id id;

  /// The one of this io_context; made when it is first asked for.
  static PacketLoop& of(boost::asio::io_context& io);
  /// Called by of() only. @throw std::system_error
  explicit PacketLoop(boost::asio::execution_context& io);

  /// Runs everything until the io_context is stopped.
  /// @param spin looks for packets for so long before it waits: for a core that has nothing else to do. If it is 0,
  ///        it shares its core as CoreSharing says.
  void run(std::chrono::nanoseconds spin = {});

  /// Calls `call` at the end of this turn, when all that is ready has been read, so that what a turn leads to is
  /// written together.
  void at_turn_end(std::function<void()> call);
  /// How many turns are over.
  std::uint64_t turns() const { return turns_; }
  /// Packets pass: the process is awake now, and will be again in a moment.
  bool packets_pass() const { return hot_; }
  /// A process of this host has been given something in this turn, such as the node's CPU, and may answer.
  void expect_answer() { answer_due_ = true; }
  /// The process is scheduled as it was before packets passed: for the program that is executed in its place.
  void end_core_sharing() { sharing_.end(); }

 private:
  friend class Watch;
  using Clock = std::chrono::steady_clock;

  void shutdown() override;
  void add(const std::shared_ptr<Watch::State>& watch);
  void change(const std::shared_ptr<Watch::State>& watch, int operation);
  void remove(std::shared_ptr<Watch::State> watch);
  void call_later(const std::shared_ptr<Watch::State>& watch);
  void found_packets(const Watch::State& watch) { last_found_ = &watch; }

  /// @return whether anything but the cold timer was ready
  bool turn(bool may_sleep);
  /// @return whether packets have come where the last ones did
  bool look_first();
  void call_those_again();
  void end_turn();
  /// A turn that does not wait: does what was asked for outside of a turn.
  void catch_up();
  void finish_soon();
  bool has_work() const { return !again_.empty() || !at_turn_end_.empty(); }
  void run_hot(std::chrono::nanoseconds spin);
  void poll_asio_when_due(Clock::time_point now);
  void let_asio_wait();
  void take_from_asio();

  boost::asio::io_context& io_;
  process::UniqueFd set_;                        ///< the epoll set
  boost::asio::posix::stream_descriptor asios_;  ///< the same while Asio waits for it
  process::UniqueFd cold_timer_;                 ///< ticks every kQuietPeriod while packets pass
  std::vector<std::shared_ptr<Watch::State>> again_, called_again_, stopped_;
  std::vector<std::function<void()>> at_turn_end_;
  Clock::time_point last_ready_{};
  Clock::time_point last_polled_{};  ///< Asio
  unsigned in_a_row_ = 0;            ///< times that something came soon after the last
  std::size_t watches_ = 0;
  const Watch::State* last_found_ = nullptr;  ///< where packets have come last
  bool asked_ = false;                        ///< the kernel what is ready, in the last turn
  bool asio_waits_ = false;
  bool running_ = false;  ///< in run()
  bool in_turn_ = false;
  bool hot_ = false;  ///< packets pass: run() waits for the set itself
  bool posted_ = false;
  bool cold_due_ = false;
  CoreSharing sharing_;
  bool answer_due_ = false;  ///< in this turn
  std::uint64_t turns_ = 0;
};

/// A timer that is exact while packets pass too, when Asio's may be PacketLoop::kColdPeriod late.
class PacketTimer {
 public:
  /// @throw std::system_error
  PacketTimer(boost::asio::io_context& io, std::function<void()> on_time);

  /// Calls back once, at `when`; replaces an earlier instant.
  void expires_at(std::chrono::steady_clock::time_point when);
  void cancel();

 private:
  process::UniqueFd timer_;
  Watch watch_;
};

/// What a Watch and its loop share. The loop keeps it until the end of the turn in which it was stopped.
struct Watch::State {
  PacketLoop* loop = nullptr;  ///< null: stopped
  int fd = -1;
  std::uint32_t events = 0;
  Trigger trigger = Trigger::edge;
  OnReady on_ready;
  bool again = false;
};

/// @throw std::system_error
inline int make_timer() {
  const int timer = ::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
  if (timer < 0) process::throw_errno("cannot make a timer");
  return timer;
}

/// The timer runs out at `when` (0: never), then every `period` (0: only once). Setting it again forgets that it has
/// run out, so one without a period need not be read. @param flags TFD_TIMER_ABSTIME, or 0
inline void set_timer(int timer, int flags, std::chrono::nanoseconds when, std::chrono::nanoseconds period) {
  const auto spec_of = [](std::chrono::nanoseconds time) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    return timespec{time.count() / kSecond, time.count() % kSecond};
  };
  const itimerspec spec{spec_of(period), spec_of(when)};
  ::timerfd_settime(timer, flags, &spec, nullptr);
}

/// Reads a timer that has run out: one with a period goes on only then.
inline void tick_again(int timer) {
  std::uint64_t times;
  [[maybe_unused]] const auto got = ::read(timer, &times, sizeof times);
}

/// Bytes a socket has not taken yet, in order, up to a limit.
class Backlog {
 public:
  explicit Backlog(std::size_t limit) : limit_(limit) {}

  bool empty() const { return done_ == bytes_.size(); }
  std::size_t size() const { return bytes_.size() - done_; }
  /// In memory: those too that have gone out and are still in front of the others.
  std::size_t kept() const { return bytes_.size(); }
  wire::ByteView view() const { return {bytes_.data() + done_, size()}; }

  /// @return false: too much; nothing was added.
  bool add(wire::ByteView more) {
    if (size() + more.size > limit_) return false;
    std::vector<std::uint8_t>& bytes = to_append();
    bytes.insert(bytes.end(), more.begin(), more.end());
    return true;
  }
  /// For a writer that appends; until the next call. What it has appended may be too much: see is_over_limit().
  std::vector<std::uint8_t>& to_append() {
    drop_done();
    return bytes_;
  }
  bool is_over_limit() const { return size() > limit_; }
  void remove(std::size_t count) {
    done_ += count;
    if (empty()) clear();
  }
  void clear() {
    bytes_.clear();
    done_ = 0;
  }

 private:
  /// One that is never empty would grow for ever. Moving the rest to the front is expensive, so it is done only when at
  /// least as much has gone out.
  void drop_done() {
    if (done_ < size()) return;
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(done_));
    done_ = 0;
  }

  std::size_t limit_;
  std::vector<std::uint8_t> bytes_;
  std::size_t done_ = 0;
};

}  // namespace limb_ring::event_loop
