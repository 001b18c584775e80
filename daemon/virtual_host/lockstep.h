#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "config/ring_config.h"
#include "host/session.h"
#include "host/turn_keeper.h"
#include "runtime/cpu/cpu_status.h"
#include "sim/virtual_ring.h"
#include "virtual_host/boots.h"

namespace limb_ring::virtual_host {

/// Who goes by the ring's clock, and whose turn it is. What programs do in an instant counts in the order of the nodes;
/// time goes on when all wait. A CPU that boots, or whose process is ending, holds the clock at an instant that does
/// not depend on how long that really takes.
class Lockstep final : public host::TurnKeeper {
 public:
  /// All outlive this. No CPU before its boot_time is over.
  Lockstep(sim::VirtualRing& ring, const config::RingConfig& config);

  // From the host ports.
  std::chrono::nanoseconds now() const override;
  void greeted(std::uint8_t node, std::function<void()> attach) override;
  void joined(std::uint8_t node, const std::shared_ptr<host::Session>& session) override;
  void has_news() override { news_ = true; }
  void disturbed() override { disturbed_ = true; }
  void credited(std::uint8_t node, unsigned packets) override { on_credited(node, packets); }
  /// What is known of the CPU process of a node has changed.
  void cpu_changed(std::uint8_t node, const runtime::CpuStatus& cpu);
  /// That process was sent a signal: stopped, it is out of the lockstep at this very instant, and continued, in it
  /// again; one that ends it holds the clock until it has.
  void cpu_signalled(std::uint8_t node, int number);

  /// @name Faults of whole nodes, called while no program acts
  ///@{
  /// Its clients are gone, and nobody boots there.
  void node_died(std::uint8_t node);
  /// It has started: its CPU, where others start that, is waited for as at the ring's start.
  void node_started(std::uint8_t node) { boots_.expect_bridge(node); }
  /// Its programs have no turns, and time does not wait for them.
  void node_frozen(std::uint8_t node) { frozen_.insert(node); }
  void node_thawed(std::uint8_t node);
  ///@}

  /// Something has happened that somebody is to learn of before time goes on; forgets it.
  bool take_news() { return std::exchange(news_, false); }
  bool has_news_now() const { return news_; }
  /// A program acts: time stands.
  bool somebody_acts() { return acting() != nullptr; }
  /// Takes what they say, one after the other, waiting for it a little. One that takes too long is stuck from then on.
  void listen();
  /// Gives those programs a turn that have something, or have waited until now: one of each node, since what another
  /// node's does meanwhile is seen later in any case. @return false where there is none
  bool give_turns();
  /// Time goes on to there at most; kNever: as far as the ring likes.
  core::Time next_wake() const;
  /// A CPU boots or ends, and time stands at that instant until it has.
  core::Time held_at() const { return boots_.held_at(); }
  /// As Boots.
  bool attach_those_due() { return boots_.attach_those_due(); }

  /// The program that is the CPU of that node does not answer, or is stopped.
  bool is_stuck(std::uint8_t node) const;
  /// As TurnKeeper::credited().
  std::function<void(std::uint8_t node, unsigned packets)> on_credited = [](std::uint8_t, unsigned) {};
  /// A program does not answer. @param program its name
  std::function<void(std::uint8_t node, const std::string& program)> on_stuck = [](std::uint8_t, const std::string&) {};

  /// Why a run like this one would be another: empty where nothing is known that would make it so.
  std::string not_repeatable() const;

 private:
  using Instant = std::chrono::steady_clock::time_point;
  struct Program {
    std::shared_ptr<host::Session> session;
    Instant turn_since{};
    bool stuck = false;
    bool dies = false;  ///< was sent a signal that ends it
  };
  using Key = std::pair<std::uint8_t, host::ClientId>;
  using Entry = std::pair<const Key, Program>;

  bool is_away(const Entry& entry) const;
  void goes_on(std::uint8_t node);
  std::chrono::milliseconds patience_with(std::uint8_t node) const;
  Entry* acting();
  bool hear(Entry& entry);
  void gets_stuck(std::uint8_t node, Program& program);
  void forget_gone();

  sim::VirtualRing& ring_;
  const config::RingConfig& config_;
  std::map<Key, Program> programs_;
  std::set<std::uint8_t> frozen_;
  std::set<std::uint8_t> hung_;  ///< nodes whose CPU was stopped
  Boots boots_;
  bool news_ = false;
  bool disturbed_ = false;
  bool somebody_was_stuck_ = false;
  bool left_ = false;  ///< a CPU has ended, or was stopped, by others
};

}  // namespace limb_ring::virtual_host
