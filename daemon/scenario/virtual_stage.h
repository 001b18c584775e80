#pragma once

#include <memory>

#include "scenario/senders.h"
#include "scenario/stage.h"
#include "scenario/supervisor.h"
#include "sim/watched_ring.h"
#include "sim_tools/virtual_line_faults.h"

namespace limb_ring::scenario {

/// The ring of a scenario under a virtual clock, with its CPUs, what they send, and what breaks.
class VirtualStage final : public Stage {
 public:
  /// @param scenario outlives this
  VirtualStage(const Scenario& scenario, std::uint64_t seed);
  VirtualStage(const VirtualStage&) = delete;
  VirtualStage& operator=(const VirtualStage&) = delete;

  /// For observers, such as a capture.
  sim::VirtualRing& ring() { return *ring_; }

  unsigned size() const override { return ring_->size(); }
  const std::string& name(NodeId id) const override { return scenario_.ring.nodes[id].name; }
  bool alive(NodeId id) const override { return ring_->alive(id); }
  core::NodeState state(NodeId id) const override { return members_[id]->state(); }
  unsigned ring_size(NodeId id) const override { return members_[id]->ring_size(); }
  std::optional<wire::Beacon> heard(NodeId by, NodeId of) const override;
  std::uint64_t counter(NodeId id, const std::string& name) const override;
  const Tally& tally(const std::string& send) const override { return senders_.tally(send); }
  nanoseconds allowed(const Limit& limit) const override { return limit.sim; }

  std::optional<Failure> begin() override;
  core::Duration now() const override { return ring_->now() - start_; }
  bool exact() const override { return true; }
  bool run_until(const std::function<bool()>& done, core::Duration until, const std::string& what) override;
  /// The ring's promises.
  std::optional<Failure> broken() const override;

  std::optional<Failure> apply(const Fault& fault) override;
  void send(const Send& send) override { senders_.begin(send); }

 private:
  void do_it(const Fault& fault);
  void apply(const Fault& fault, NodeId id);
  void end_later(const Fault& fault);
  void start(NodeId id);
  void came(const core::Event& event, NodeId at);

  const Scenario& scenario_;
  std::unique_ptr<sim::WatchedRing> ring_;
  core::Time start_{};
  std::vector<const core::Membership*> members_;  ///< read without waking the node
  std::vector<bool> frozen_;
  Cpus cpus_;
  Senders senders_;
  Supervisor supervisor_;
  sim::VirtualLineFaults lines_;
};

}  // namespace limb_ring::scenario
