#pragma once

#include <optional>

#include "sim/input_checker.h"
#include "sim/output_checker.h"
#include "sim/result_checker.h"
#include "sim/ring_record.h"

namespace limb_ring::sim {

/// Checks every promise of the ring at every event of a virtual ring, from outside: it knows what CPUs ask for and
/// get, the slices on the lines, the pins, and the state that a node shows; never what the controller counts. The first
/// broken promise is kept.
class Invariants : public Observer {
 public:
  /// Watches `ring` from now on; must live as long as it runs.
  explicit Invariants(VirtualRing& ring);

  const std::optional<Violation>& violation() const { return record_.violation; }
  /// No living node owes a result.
  bool all_ended() const;
  /// At the end, when nothing is under way any more: everything asked for must have ended.
  void finish();
  /// All that later events are judged by. (study/explore/state_hash.h) @pre no promise was broken
  template <class Archive>
  void archive(Archive& a) {
    a("record", record_)("outputs", outputs_)("inputs", inputs_)("results", results_);
  }

  void asked(NodeId node, const core::SendRequest& request, Time now) override;
  void asked(NodeId node, const core::InterruptRequest& request, Time now) override;
  void leaves(NodeId node, const wire::Slice& slice, Time now) override;
  void arrives(NodeId node, const wire::Slice& slice, Time now) override;
  void word_arrives(NodeId node, wire::FoldWord word, Line line, Time now) override;
  void input_changes(NodeId node, Line line, Time now) override;
  void output_ready(NodeId node, bool ready, Time now) override;
  void cpu_present(NodeId node, bool present, Time now) override;
  void event(NodeId node, const core::Event& event) override;
  void packet(NodeId node, const core::ReceivedPacket& packet) override;
  void incident(NodeId node, Incident incident, Time now, Line line) override;

 private:
  void state_changes(NodeId node, core::NodeState state);
  void starts_over(NodeId node);
  void starts(NodeId node, Time now);

  RingRecord record_;
  OutputChecker outputs_;
  InputChecker inputs_;
  ResultChecker results_;
};

}  // namespace limb_ring::sim
