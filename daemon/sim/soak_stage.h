#pragma once

#include <vector>

#include "sim/stage.h"

namespace limb_ring::scenario {

/// A ring as in `ring_sim soak`, so that a failure found there can be written as a scenario: plain nodes with short
/// times and few buffers (sim::set_short_times); lines that are all alike, with a rate or without one; CPUs that are
/// there as soon as their nodes are, and do nothing by themselves. Single slices can be lost or damaged, even while
/// the nodes join: time counts from when they start, and steps at 0s come before that.
///
/// At its end all is mended, and runs on until it is calm (sim::run_until_calm): each send must have ended, and the
/// ring must be whole again and stay silent for 20 ms.
class SoakStage final : public ModelStage {
 public:
  /// @param scenario outlives this
  SoakStage(const Scenario& scenario, std::uint64_t seed);

  /// Its CPUs are not programs, so that few of their faults mean anything.
  static bool can(const Fault& fault);

  std::optional<Failure> begin() override { return std::nullopt; }
  bool run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) override;
  /// The ring's promises.
  std::optional<Failure> broken() const override { return failure_of(invariants_.violation()); }
  using ModelStage::apply;
  void apply(const SoakAction& action) override;
  std::optional<Failure> end() override;

 private:
  /// A slice that will be hit.
  struct Strike {
    SoakAction what;
    core::Line line;
    unsigned left;  ///< slices until then, that one too
  };

  SoakStage(const Scenario& scenario, std::uint64_t seed, std::unique_ptr<sim::VirtualRing> ring);
  bool cpu_sends(NodeId id) const override { return ring_->alive(id); }
  void tap(NodeId id, core::Line line);
  void pass(NodeId id, core::Line line, const wire::Slice& slice, wire::SliceWriter& arriving);
  /// The strike that hits the slice which passes there now.
  std::optional<SoakAction> strike_at(NodeId id, core::Line line);
  void apply_to_cpu(const Fault& fault, NodeId id) override;
  void end_at_cpu(Name, NodeId id) override { ring_->set_cpu_reads(id, true); }
  void mend_all();

  std::unique_ptr<sim::VirtualRing> ring_;
  sim::Invariants invariants_;
  std::vector<Strike> strikes_;
  bool quiet_ = false;
  std::uint64_t slices_when_quiet_ = 0;
};

}  // namespace limb_ring::scenario
