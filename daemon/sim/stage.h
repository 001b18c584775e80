#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/membership/membership.h"
#include "core/time.h"
#include "sim/cpus.h"
#include "sim/goals.h"
#include "sim/invariants.h"
#include "sim/scenario.h"
#include "sim/virtual_line_faults.h"

namespace limb_ring::scenario {

/// What happened, for people; if programs are to know it, too, its kind and node as fields.
struct Note {
  std::string words;
  std::string event;  ///< cpu_ended, cpu_does_not_answer, cpu_lets_no_time_pass; empty: for people only
  std::string node;   ///< its name
};

/// What can be seen of a ring at one moment: all that conditions speak of.
class StageView {
 public:
  virtual ~StageView() = default;

  virtual unsigned size() const = 0;  ///< nodes, living or not
  virtual const std::string& name(NodeId id) const = 0;
  /// Neither dead nor frozen. If it is not alive, the values below mean nothing.
  virtual bool alive(NodeId id) const = 0;
  virtual core::NodeState state(NodeId id) const = 0;
  virtual unsigned ring_size(NodeId id) const = 0;  ///< as that node has learned it; 0: not yet
  /// The last beacon of `of` that `by` has heard, its nodes as places; nothing if none. Only the CPU's state and
  /// boots, and the break, are used.
  virtual std::optional<wire::Beacon> heard(NodeId by, NodeId of) const = 0;
  /// By name, of core/counters.h; of the node since its last start. 0 if it is dead.
  virtual std::uint64_t counter(NodeId id, const std::string& name) const = 0;
  /// All zero if nothing of that name was sent yet.
  virtual const Tally& tally(const std::string& send) const = 0;

  /// Which of the two limits counts here.
  virtual nanoseconds allowed(const Limit& limit) const = 0;
};

/// What a scenario is played on: a ring to observe and to act on, and its time. Under a virtual clock all
/// is exact; live, it is polled every few hundredths of a second, and steps may be late.
class Stage : public StageView {
 public:
  struct Failure {
    std::string expected, seen;
  };

  /// Brings the ring up. Time counts from then. @return what was not as expected
  virtual std::optional<Failure> begin() = 0;
  virtual core::Duration now() const = 0;
  /// True: a step whose time has passed is an error. False: it is then done at once.
  virtual bool exact() const = 0;
  /// Lets time go on and polls, until `done` is true or `until` has come. @param what for people who wait
  /// @return what `done` said last
  virtual bool run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) = 0;
  /// Checks what is expected of every ring, whatever the scenario says. @return the first expectation that was not met
  virtual std::optional<Failure> broken() const = 0;
  /// Unrequested events since the last call, for the report.
  virtual std::vector<Note> take_notes() { return {}; }
  /// How often each goal was met so far, by place in sim::goals(). @pre the scenario has goals
  virtual std::vector<std::uint64_t> goals_met() const { return {}; }

  /// Returns when it has taken effect; a CPU that was reset boots meanwhile. @return why it could not be done
  virtual std::optional<Failure> apply(const Fault& fault) = 0;
  virtual void send(const Send& send) = 0;
  /// @pre this is the soak's world
  virtual void apply(const SoakAction&) {}
  /// Called when all steps are done. @return an expectation of the stage itself that is not met at the end
  virtual std::optional<Failure> end() { return std::nullopt; }
};

/// A virtual ring as a stage, whoever its CPUs are: what is seen of it, at every event, and what is sent.
/// The ring's nodes may have ids other than their places in the scenario.
class RingStage : public Stage {
 public:
  RingStage(const RingStage&) = delete;
  RingStage& operator=(const RingStage&) = delete;

  /// For observers, such as a capture.
  sim::VirtualRing& ring() { return ring_; }

  unsigned size() const override { return static_cast<unsigned>(ring_.order().size()); }
  const std::string& name(NodeId place) const override { return scenario_.ring.nodes[place].name; }
  bool alive(NodeId place) const override { return ring_.alive(id_of(place)); }
  core::NodeState state(NodeId place) const override { return membership(place).state(); }
  unsigned ring_size(NodeId place) const override { return membership(place).ring_size(); }
  std::optional<wire::Beacon> heard(NodeId by, NodeId of) const override;
  std::uint64_t counter(NodeId place, const std::string& name) const override;
  const Tally& tally(const std::string& send) const override { return senders_.tally(send); }
  nanoseconds allowed(const Limit& limit) const override { return limit.sim; }
  std::vector<std::uint64_t> goals_met() const override { return goals_->met(); }

  core::Duration now() const override { return ring_.now() - start_; }
  bool exact() const override { return true; }
  void send(const Send& send) override;

 protected:
  /// @param scenario, ring outlive this
  RingStage(const Scenario& scenario, sim::VirtualRing& ring, std::uint64_t seed)
      : scenario_(scenario),
        ring_(ring),
        senders_(
            ring, [this](NodeId id) { return cpu_sends(id); }, seed) {
    if (!scenario.sometimes.empty()) goals_.emplace(ring);
  }

  const Scenario& scenario() const { return scenario_; }
  Senders& senders() { return senders_; }
  NodeId id_of(NodeId place) const { return ring_.order()[place]; }
  NodeId place_of(NodeId id) const;
  /// The same fault, its nodes as ids of the ring.
  Fault in_ring(Fault fault) const;
  /// Time counts from now.
  void start_counting() { start_ = ring_.now(); }
  /// When it is so much later than the start.
  core::Time at(core::Duration since_start) const { return start_ + since_start; }
  /// The promise that was broken, if one was.
  std::optional<Failure> failure_of(const std::optional<sim::Violation>& violation) const;

 private:
  std::string with_names(const sim::Words& words) const;
  const core::Membership& membership(NodeId place) const { return ring_.controller(id_of(place)).membership(); }
  /// The CPU of that node of the ring asks for what the scenario has it send.
  virtual bool cpu_sends(NodeId id) const = 0;

  const Scenario& scenario_;
  sim::VirtualRing& ring_;
  core::Time start_{};
  Senders senders_;
  std::optional<sim::GoalCounts> goals_;  ///< only if somebody asks
};

/// A virtual ring as a stage whose CPUs are models, not programs: time goes on at once, and faults of lines and nodes
/// are the same whatever the models do.
class ModelStage : public RingStage {
 public:
  using Name = fault::Name;

  bool run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) override;
  std::optional<Failure> apply(const Fault& fault) override;

 protected:
  /// @param scenario, ring outlive this
  ModelStage(const Scenario& scenario, sim::VirtualRing& ring, std::uint64_t seed)
      : RingStage(scenario, ring, seed), lines_(ring, seed), frozen_(ring.size(), false) {}

  sim::VirtualLineFaults& lines() { return lines_; }
  /// A dead node is there again, a frozen one goes on.
  void bring_back(NodeId id);

 private:
  /// A fault of the node's CPU.
  virtual void apply_to_cpu(const Fault& fault, NodeId id) = 0;
  /// Its time is over, and nothing has ended it before.
  virtual void end_at_cpu(Name fault, NodeId id) = 0;
  /// The node has a new process.
  virtual void started(NodeId) {}
  fault::Node node(NodeId id);
  void apply_to_node(Name fault, NodeId id);
  void end_later(const Fault& fault, NodeId id);

  sim::VirtualLineFaults lines_;
  std::vector<bool> frozen_;
  LastingFaults lasting_;
};

/// The ring of a scenario under a virtual clock, with models of its CPUs, what they send, and what breaks.
class VirtualStage final : public ModelStage {
 public:
  /// @param scenario outlives this
  VirtualStage(const Scenario& scenario, std::uint64_t seed);

  std::optional<Failure> begin() override;
  /// The ring's promises.
  std::optional<Failure> broken() const override { return failure_of(ring_->violation()); }

 private:
  VirtualStage(const Scenario& scenario, std::uint64_t seed, std::unique_ptr<sim::WatchedRing> ring);
  bool cpu_sends(NodeId id) const override { return cpus_.sends(id); }
  void apply_to_cpu(const Fault& fault, NodeId id) override;
  void end_at_cpu(Name fault, NodeId id) override { cpus_.end(fault, id); }
  void started(NodeId id) override;
  void came(const core::Event& event, NodeId at);

  std::unique_ptr<sim::WatchedRing> ring_;
  Cpus cpus_;
  Supervisor supervisor_;
};

}  // namespace limb_ring::scenario
