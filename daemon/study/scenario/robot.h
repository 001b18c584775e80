#pragma once

#include <memory>

#include "sim/watched_ring.h"
#include "study/faulty_lines.h"
#include "study/scenario/senders.h"

namespace limb_ring::study::scenario {

/// The ring of a scenario under a virtual clock, with its CPUs, what they send, and what breaks.
class Robot {
 public:
  /// @param scenario outlives this
  Robot(const Scenario& scenario, std::uint64_t seed);
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  sim::WatchedRing& ring() { return *ring_; }
  const sim::WatchedRing& ring() const { return *ring_; }
  const std::string& name(NodeId id) const { return scenario_.ring.nodes[id].name; }
  const core::Membership& membership(NodeId id) const { return *members_[id]; }
  const Senders& senders() const { return senders_; }

  void apply(const Fault& fault);
  void send(const Send& send) { senders_.begin(send); }

 private:
  void apply(const Fault& fault, NodeId id);
  void end_later(const Fault& fault);
  void start(NodeId id);
  void came(const core::Event& event, NodeId at);

  const Scenario& scenario_;
  std::unique_ptr<sim::WatchedRing> ring_;
  std::vector<const core::Membership*> members_;  ///< to look at a node without waking it
  std::vector<bool> frozen_;
  Cpus cpus_;
  Senders senders_;
  FaultyLines lines_;
};

}  // namespace limb_ring::study::scenario
