#pragma once

#include <memory>

#include "sim/cpus.h"
#include "sim/model_stage.h"
#include "sim/scenario_supervisor.h"
#include "sim/watched_ring.h"

namespace limb_ring::scenario {

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
  void started(NodeId id) override;
  void came(const core::Event& event, NodeId at);

  std::unique_ptr<sim::WatchedRing> ring_;
  Cpus cpus_;
  Supervisor supervisor_;
};

}  // namespace limb_ring::scenario
