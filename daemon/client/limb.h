#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/command_filter.h"
#include "client/timestamps.h"
#include "limb_ring/joint_node.h"
#include "limb_ring/payload/joint_state.h"

namespace limb_ring::firmware {

/// The joints of one node: commands in, goals for whoever moves them, their state out (protocol.md section 9.1). No IO;
/// time is an argument.
///
/// A joint obeys a command for `command_timeout`, then it goes to its safe state, in which it also starts.
class Limb {
 public:
  using Joint = payload::JointState::Joint;

  /// @param at_once joints are moved up to each instant at which a goal changes, too
  /// @throw std::invalid_argument if the node has more joints than one packet carries
  Limb(const NodeSetup& setup, bool at_once, nanoseconds now);

  /// Who moves them. @pre it is set before time goes on, if there are joints
  void moved_by(JointNode::Step step) { step_ = std::move(step); }

  /// What a packet says to this node. Every verdict is counted; all but `obey` as refused, too.
  Verdict command(const payload::Decoded<payload::JointCommand>& command, const Timestamps& now);
  /// All joints to their safe states, until a command resumes.
  void stop(const Timestamps& now);
  /// Time has come so far.
  void advance(nanoseconds now);
  /// The state at `now`, under the next sequence number. @throw std::logic_error as JointNode::run()
  payload::JointState sample(const Timestamps& now);
  /// So many samples are not taken: their sequence numbers stay unused, so the receiver knows.
  void leave_out(std::uint64_t samples) { sequence_ = static_cast<std::uint16_t>(sequence_ + samples); }

  const std::vector<Joint>& joints() const { return joints_; }
  const std::vector<JointGoal>& goals() const { return goals_; }
  bool stopped() const { return filter_.stopped(); }
  std::uint64_t count(Verdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }

 private:
  Verdict judge(const payload::Decoded<payload::JointCommand>& command, const Timestamps& now);
  void obey(const payload::JointCommand& command, nanoseconds now);
  void go_safe(std::size_t joint);
  void go_safe_at(nanoseconds now);
  void move_to(nanoseconds now);
  void add_mode(payload::JointState::Mode& mode) const;

  std::string node_;
  std::vector<NodeJoint> limits_;
  nanoseconds command_timeout_;
  bool at_once_;
  JointNode::Step step_;
  std::vector<Joint> joints_;
  std::vector<JointGoal> goals_;
  std::vector<nanoseconds> commanded_until_;
  nanoseconds moved_to_;
  CommandFilter filter_;
  std::array<std::uint64_t, kVerdicts> counts_{};  ///< by Verdict
  std::uint16_t sequence_ = 0;
  std::uint16_t refused_ = 0;
  bool refused_since_sample_ = false;
};

}  // namespace limb_ring::firmware
