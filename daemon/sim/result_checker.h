#pragma once

#include <string>
#include <vector>

#include "sim/ring_record.h"

namespace limb_ring::sim {

/// Judges the results that CPUs get: each send has one, in time, justified by the lines (ResultJudge) and by the state
/// that its node shows. (protocol.md sections 4.3 to 4.6)
class ResultChecker {
 public:
  explicit ResultChecker(RingRecord& record) : record_(record), unexplained_(record.ring.size()) {}

  void ends(NodeId node, const core::SendEnded& end, Time at_end);
  /// A state explains results that were given just before.
  void state_changes(NodeId node, core::NodeState state);
  /// The node has restarted.
  void start(NodeId node) { unexplained_[node].clear(); }
  /// Sends that are due by now must have ended. @param all true: all sends, at the end of a run
  void judge_open(NodeId node, bool all);
  /// Complains of results that no state has explained in time.
  void judge_unexplained(NodeId node);
  template <class Archive>
  void archive(Archive& a) {
    a("unexplained", unexplained_);
  }

 private:
  /// A result for which its node has to show a state.
  struct Unexplained {
    Time when;
    core::Outcome outcome;
    std::string what;

    template <class Archive>
    void archive(Archive& a) {
      a("when", when)("outcome", outcome)("what", what);
    }
  };

  Time last_hello_of(NodeId destination) const;
  ResultJudge judge_of(NodeId node, const Sent& sent) const;

  RingRecord& record_;
  std::vector<std::vector<Unexplained>> unexplained_;  ///< by node
};

}  // namespace limb_ring::sim
