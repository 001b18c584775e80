#pragma once

#include <chrono>
#include <cstdint>

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

}  // namespace limb_ring::event_loop
