#pragma once

#include <optional>
#include <stdexcept>

#include "sim/input_checker.h"
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
  /// All that later events are judged by. (study/exploration.h) @pre no promise was broken
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

/// A promise of the ring was broken: which, when in virtual time, and the packets involved.
struct BrokenPromise : std::runtime_error {
  explicit BrokenPromise(const Violation& violation)
      : std::runtime_error("promise broken at " + std::to_string(core::picoseconds(violation.at.time_since_epoch())) +
                           " ps: " + to_string(violation.promise) + ": " + violation.what()) {}
};

/// A virtual ring whose every promise is checked at every event.
class WatchedRing : public VirtualRing {
 public:
  explicit WatchedRing(const VirtualRingOptions& options) : VirtualRing(options), invariants_(*this) {}

  const std::optional<Violation>& violation() const { return invariants_.violation(); }
  /// @throw BrokenPromise
  void check() const {
    if (violation()) throw BrokenPromise(*violation());
  }

 private:
  Invariants invariants_;
};

}  // namespace limb_ring::sim
