#pragma once

#include <deque>
#include <map>
#include <memory>
#include <random>

#include "sim/cpus.h"
#include "sim/scenario.h"
#include "sim/stage.h"
#include "tools/ringctl/live_nodes.h"
#include "tools/ringctl/up.h"
#include "tools/scenario_cpu/taken_board.h"

namespace limb_ring::ringctl {

/// Sends what a scenario says on live daemons, as a tool beside each node's CPU, and keeps account by name. A CPU
/// that does not run asks for nothing; an interrupt input is pulled whatever its CPU does.
///
/// At most kMostWaiting packets of a stream wait at a node. So on a busy machine a stream is late, instead of its
/// packets being rejected.
class LiveSenders {
 public:
  using Clock = LiveNodes::Clock;
  static constexpr unsigned kMostWaiting = 16;

  /// All outlive this. @param seed of where in its period a stream begins
  LiveSenders(const scenario::Scenario& scenario, LiveNodes& nodes, std::uint64_t seed);

  void begin(const scenario::Send& send);
  /// Asks for what is due by now. @return when the next is
  Clock::time_point act();
  /// Whether that fault keeps a CPU from sending.
  void set_silent(std::size_t place, fault::Name by, bool silent);
  /// Another CPU is there, or none.
  void set_whole(std::size_t place) { silenced_by_[place] = 0; }

  void came(std::size_t place, const Message& message);
  /// The counts of a named send; `taken` counts only pins here.
  const scenario::Tally& tally(const std::string& send) const { return tallies_[mark_of(send)]; }
  /// The first byte of a send's packets.
  std::uint8_t mark_of(const std::string& send) const;

 private:
  /// One node's part of a send.
  struct Job {
    scenario::Send send;
    std::size_t from;
    std::uint8_t mark;
    std::uint64_t left;
    Clock::time_point due;
    unsigned waiting = 0;  ///< for their results
  };
  struct Asked {
    Job* job;
    Clock::time_point at;
  };

  bool can_send(const Job& job);
  void ask(Job& job);
  std::uint32_t ask(HostPort& port, const Job& job);
  std::uint8_t id_of(std::uint8_t place_or_all) const;
  void came(std::size_t place, const Result& result);
  void came(const Observed& seen);

  const scenario::Scenario& scenario_;
  LiveNodes& nodes_;
  std::mt19937_64 random_;
  std::vector<std::uint32_t> silenced_by_;  ///< sets of fault::bit_of()
  std::vector<std::string> names_;
  std::vector<scenario::Tally> tallies_;
  std::deque<Job> jobs_;                                                        ///< they stay where they are
  std::map<std::pair<std::size_t, std::uint32_t>, Asked> asked_;                ///< by source and token
  std::map<std::pair<std::uint8_t, std::uint8_t>, std::uint8_t> of_interrupt_;  ///< by source's id and factor
};

/// A ring of live daemons, started for this alone, as a stage for scenarios. What is seen of it comes from fresh
/// status rows of all daemons at every poll. All daemons have ended when this is destroyed. (ours)
///
/// begin(), run_until() and apply() may throw Interrupted.
class LiveStage final : public scenario::Stage {
 public:
  /// Nothing is started before begin(). @param plan whose CPUs are scenario_cpu. All outlive this
  LiveStage(const scenario::Scenario& scenario, std::uint64_t seed, const RingPlan& plan, process::SignalWait& signals);

  unsigned size() const override { return static_cast<unsigned>(nodes_.size()); }
  const std::string& name(wire::NodeId id) const override { return scenario_.ring.nodes[id].name; }
  bool alive(wire::NodeId id) const override { return nodes_.row(id) != nullptr; }
  core::NodeState state(wire::NodeId id) const override;
  unsigned ring_size(wire::NodeId id) const override;
  std::optional<wire::Beacon> heard(wire::NodeId by, wire::NodeId of) const override;
  /// Since its last start.
  std::uint64_t counter(wire::NodeId id, const std::string& name) const override;
  const scenario::Tally& tally(const std::string& send) const override;
  std::chrono::nanoseconds allowed(const scenario::Limit& limit) const override { return limit.live; }

  std::optional<Failure> begin() override;
  core::Duration now() const override { return Clock::now() - start_; }
  bool exact() const override { return false; }
  bool run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) override;
  /// That no daemon ends by itself.
  std::optional<Failure> broken() const override { return broken_; }

  std::optional<Failure> apply(const scenario::Fault& fault) override;
  void send(const scenario::Send& send) override { senders_.begin(send); }

 private:
  using Clock = LiveNodes::Clock;

  wire::NodeId place_of(std::uint8_t id) const;
  std::vector<std::size_t> present() const;  ///< at the start
  std::string first_not_ready() const;
  void poll();
  void do_it(const scenario::Fault& fault);
  void apply_to_node(fault::Name name, std::size_t place);
  bool is_not_there(fault::Name name, std::size_t place);
  void apply_at_daemon(fault::Fault fault, std::size_t place);
  Clock::time_point turn();

  /// When a fault that we have to end, or know the end of, is over.
  struct Ending {
    Clock::time_point when;
    fault::Name of = fault::Name::freeze;
    wire::NodeId node;
    unsigned number = 0;  ///< see LastingFaults
  };
  void end(const Ending& ending);

  const scenario::Scenario& scenario_;
  const RingPlan& plan_;
  LiveNodes nodes_;
  LiveSenders senders_;
  std::mt19937_64 random_;
  Clock::time_point start_{};
  std::vector<std::unique_ptr<scenario_cpu::TakenBoard>> boards_;
  std::vector<std::optional<status::NodeRow>>
      first_rows_;  ///< at the start: what joining counted is not part of the scenario
  std::optional<Failure> broken_;
  scenario::LastingFaults lasting_;
  std::vector<Ending> endings_;         ///< to come
  mutable scenario::Tally with_taken_;  ///< what tally() said last
};

}  // namespace limb_ring::ringctl
