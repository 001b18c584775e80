#pragma once

#include <vector>

#include "sim/lasting_faults.h"
#include "sim/ring_stage.h"
#include "sim/virtual_line_faults.h"

namespace limb_ring::scenario {

/// A virtual ring as a stage whose CPUs are models, not programs: time goes on at once, and faults of lines and nodes
/// are the same whatever the models do.
class ModelStage : public RingStage {
 public:
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
  /// The node has a new process.
  virtual void started(NodeId) {}
  void do_it(const Fault& fault);
  void apply_to_node(const Fault& fault, NodeId id);
  void end_later(const Fault& fault, NodeId id);
  void freeze(NodeId id);
  void start(NodeId id);
  void thaw(NodeId id);

  sim::VirtualLineFaults lines_;
  std::vector<bool> frozen_;
  LastingFaults lasting_;
};

}  // namespace limb_ring::scenario
