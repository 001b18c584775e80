#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "node/cpu_status.h"
#include "node/session.h"
#include "sim/virtual_ring.h"

namespace limb_ring::virtual_host {

/// CPUs of a virtual ring that boot, or whose process is ending. Each stops the ring's clock at a fixed instant until
/// that is over, so that a run does not depend on how long it really takes.
class Boots {
 public:
  /// True if nobody waits for the CPU of that node: the node is frozen, or the CPU stopped.
  using IsAway = std::function<bool(std::uint8_t node)>;
  /// How long, in real time from its node's start, to wait for a CPU that others start: ROS nodes take some seconds.
  static constexpr std::chrono::seconds kAttachedWithin{30};
  /// All outlive this. No CPU attaches before its boot_time is over.
  Boots(const sim::VirtualRing& ring, const config::RingConfig& config, IsAway is_away);

  /// From now on waits for the node's CPU, if that is a bridge in lockstep, which others start.
  void expect_bridge(std::uint8_t node);
  /// The CPU of that node is a bridge in lockstep.
  bool is_bridge(std::uint8_t node) const;
  /// The CPU of a node has greeted. `attach` is called when its boot is over.
  /// @return false if it was not expected; `attach` was not called
  bool greeted(std::uint8_t node, const std::function<void()>& attach);
  /// That CPU is gone: another one is waited for.
  void left(std::uint8_t node);
  /// What is known of the CPU process of a node has changed. @return true if it is a new one
  bool changed(std::uint8_t node, const runtime::CpuStatus& cpu);
  /// The process of a node is ending, from this instant on.
  void ends(std::uint8_t node);
  bool is_ending(std::uint8_t node) const;
  /// Nobody boots there any more.
  void forget(std::uint8_t node);
  /// Called when the node is no longer away: its time limits start again now.
  void goes_on(std::uint8_t node);

  /// The instant at which time stands until these CPUs have come or gone; kNever if there are none.
  core::Time held_at() const;
  /// Attaches those whose boot is over by now, in the order of the nodes, once all of them have come.
  /// @return false if one is still waited for
  bool attach_those_due();

 private:
  struct Boot {
    core::Time at{};
    bool ends = false;                  ///< the process there was before is ending
    std::function<void()> attach = {};  ///< empty until it has greeted
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
  };

  core::Time boot_end() const;
  void drop(std::uint8_t node);
  bool is_late(std::uint8_t node, const Boot& boot) const;
  void give_up(std::uint8_t node, const Boot& boot) const;
  void give_up_late_ones();

  const sim::VirtualRing& ring_;
  const config::RingConfig& config_;
  IsAway is_away_;
  std::map<std::uint8_t, Boot> boots_;
  std::map<std::uint8_t, pid_t> pids_;  ///< the last one known
};

/// The programs that run in lockstep with the ring's clock, and which of them may act. What they do in one instant is
/// ordered by node, or in the order that a seed draws (`order` of the ring's `virtual`). Time goes on when all wait. A
/// CPU that boots or ends stops the clock at a fixed instant, so that a run does not depend on how long it really
/// takes.
class Lockstep final : public host::TurnKeeper {
 public:
  /// All outlive this. No CPU attaches before its boot_time is over.
  Lockstep(sim::VirtualRing& ring, const config::RingConfig& config);

  // From the host ports.
  std::chrono::nanoseconds now() const override;
  void greeted(std::uint8_t node, std::function<void()> attach) override;
  void left(std::uint8_t node) override;
  void joined(std::uint8_t node, const std::shared_ptr<host::Session>& session) override;
  void has_news() override { news_ = true; }
  void disturbed() override { disturbed_ = true; }
  void credited(std::uint8_t node, unsigned packets) override { on_credited(node, packets); }
  std::string holds_time(std::uint8_t node) const override;
  /// What is known of the CPU process of a node has changed.
  void cpu_changed(std::uint8_t node, const runtime::CpuStatus& cpu);
  /// The node's CPU process was sent a signal. SIGSTOP takes it out of the lockstep at this very instant, SIGCONT
  /// brings it back. After a signal that ends it, the clock stands until it has ended.
  void cpu_signalled(std::uint8_t node, int number);

  /// @name Faults of whole nodes, called while no program acts
  ///@{
  /// Its clients are gone, and nobody boots there.
  void node_died(std::uint8_t node);
  /// It has started: if others start its CPU, that is waited for as at the ring's start.
  void node_started(std::uint8_t node) { boots_.expect_bridge(node); }
  /// Its programs have no turns, and time does not wait for them.
  void node_frozen(std::uint8_t node) { frozen_.insert(node); }
  void node_thawed(std::uint8_t node);
  ///@}

  /// Whether something has happened that a program must learn of before time goes on. Clears the flag.
  bool take_news() { return std::exchange(news_, false); }
  bool has_news_now() const { return news_; }
  /// A program acts: time stands.
  bool somebody_acts() { return acting() != nullptr; }
  /// Waits briefly for messages of the acting programs, one after the other, and handles them. A program that takes too
  /// long counts as stuck from then on.
  void await_messages();
  /// Gives a turn to programs that have messages, or whose wait is over: one per node at a time. Different nodes may
  /// act side by side, as they see each other's actions only later; with an `order`, only one that it draws does.
  /// @return false if there is none
  bool give_turns();
  /// When the next program wants to wake, so how far time may go on; kNever: no limit.
  core::Time next_wake() const;
  /// As Boots.
  core::Time held_at() const { return boots_.held_at(); }
  /// As Boots.
  bool attach_those_due() { return boots_.attach_those_due(); }

  /// The program that is the CPU of that node does not answer, or is stopped.
  bool is_stuck(std::uint8_t node) const;
  /// As TurnKeeper::credited().
  std::function<void(std::uint8_t node, unsigned packets)> on_credited = [](std::uint8_t, unsigned) {};
  /// A program does not answer, or answers and lets no time pass.
  std::function<void(std::uint8_t node, const std::string& program, bool answers)> on_stuck =
      [](std::uint8_t, const std::string&, bool) {};

  /// Why this run is not repeatable; empty if no reason is known.
  std::string not_repeatable() const;

 private:
  using Instant = std::chrono::steady_clock::time_point;
  struct Program {
    std::shared_ptr<host::Session> session;
    Instant turn_since{};
    std::chrono::nanoseconds turn_at{-1};  ///< of the ring's time: its last turn
    unsigned turns = 0;                    ///< in that instant
    bool restless = false;                 ///< had too many of them: its turns are kRest apart
    bool stuck = false;
    bool dies = false;                       ///< was sent a signal that ends it
    std::chrono::nanoseconds waited_for{0};  ///< real time, since look_who_sleeps() looked last
    std::optional<std::chrono::nanoseconds> not_asleep = std::nullopt;  ///< of its process, then
    std::string holds_time = {};                                        ///< how; empty: it does not
    std::optional<Instant> told = std::nullopt;                         ///< that it does
  };
  using Key = std::pair<std::uint8_t, host::ClientId>;
  using Entry = std::pair<const Key, Program>;

  bool is_away(const Entry& entry) const;
  void goes_on(std::uint8_t node);
  std::chrono::milliseconds patience_with(std::uint8_t node) const;
  Entry* acting();
  void find_due();
  bool await_message_of(Entry& entry);
  void gets_stuck(std::uint8_t node, Program& program);
  void look_who_sleeps();
  void judge_sleep(std::uint8_t node, Program& program, std::chrono::nanoseconds window);
  std::chrono::nanoseconds next_turn(const Program& program) const;
  void begin_turn(std::uint8_t node, Program& program);
  void gets_restless(std::uint8_t node, Program& program);
  void forget_gone();

  sim::VirtualRing& ring_;
  const config::RingConfig& config_;
  std::map<Key, Program> programs_;
  std::vector<Entry*> due_;  ///< for a turn
  std::mt19937_64 order_;
  std::set<std::uint8_t> frozen_;
  std::set<std::uint8_t> hung_;  ///< nodes whose CPU was stopped
  Boots boots_;
  Instant looked_ = std::chrono::steady_clock::now();  ///< who sleeps
  bool news_ = false;
  bool disturbed_ = false;
  bool somebody_was_stuck_ = false;
  bool left_ = false;  ///< a CPU has ended, or was stopped, by others
};

}  // namespace limb_ring::virtual_host
