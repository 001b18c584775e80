#pragma once

#include <memory>

#include "scenario/cpus.h"
#include "scenario/ring_stage.h"
#include "scenario/supervisor.h"
#include "sim/watched_ring.h"
#include "sim_tools/virtual_line_faults.h"

namespace limb_ring::scenario {

/// The ring of a scenario under a virtual clock, with models of its CPUs, what they send, and what breaks.
class VirtualStage final : public RingStage {
 public:
  /// @param scenario outlives this
  VirtualStage(const Scenario& scenario, std::uint64_t seed);

  std::optional<Failure> begin() override;
  bool run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) override;
  /// The ring's promises.
  std::optional<Failure> broken() const override { return failure_of(ring_->violation()); }

  std::optional<Failure> apply(const Fault& fault) override;

 private:
  VirtualStage(const Scenario& scenario, std::uint64_t seed, std::unique_ptr<sim::WatchedRing> ring);
  bool cpu_sends(NodeId id) const override { return cpus_.sends(id); }
  void do_it(const Fault& fault);
  void apply(const Fault& fault, NodeId id);
  void end_later(const Fault& fault);
  void start(NodeId id);
  void came(const core::Event& event, NodeId at);

  std::unique_ptr<sim::WatchedRing> ring_;
  std::vector<bool> frozen_;
  Cpus cpus_;
  Supervisor supervisor_;
  sim::VirtualLineFaults lines_;
};

}  // namespace limb_ring::scenario
