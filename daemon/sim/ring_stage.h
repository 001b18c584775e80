#pragma once

#include "sim/invariants.h"
#include "sim/scenario_senders.h"
#include "sim/stage.h"

namespace limb_ring::scenario {

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

  core::Duration now() const override { return ring_.now() - start_; }
  bool exact() const override { return true; }
  void send(const Send& send) override;

 protected:
  /// @param scenario, ring outlive this
  RingStage(const Scenario& scenario, sim::VirtualRing& ring, std::uint64_t seed)
      : scenario_(scenario),
        ring_(ring),
        senders_(
            ring, [this](NodeId id) { return cpu_sends(id); }, seed) {}

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
  std::string with_names(const std::string& what) const;
  const core::Membership& membership(NodeId place) const { return ring_.controller(id_of(place)).membership(); }
  /// The CPU of that node of the ring asks for what the scenario has it send.
  virtual bool cpu_sends(NodeId id) const = 0;

  const Scenario& scenario_;
  sim::VirtualRing& ring_;
  core::Time start_{};
  Senders senders_;
};

}  // namespace limb_ring::scenario
