#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

#include "limb_ring/payload/joint_command.h"

namespace limb_ring::bridge {

/// Commands to one node that wait until others have returned. (ours)
///
/// A newer one takes the place of what older ones say of the same joints, since an old command is worth nothing; what
/// they say of other joints still counts, each with the stamp of its own. So no more wait than the node has joints.
class WaitingCommands {
 public:
  /// @return joints whose older command was replaced
  unsigned put(payload::JointCommand newer) {
    unsigned replaced = 0;
    for (payload::JointCommand& older : commands_) replaced += take_out(older, newer);
    commands_.erase(std::remove_if(commands_.begin(), commands_.end(), says_nothing), commands_.end());
    commands_.push_back(std::move(newer));
    return replaced;
  }
  /// The oldest one; null where none waits.
  const payload::JointCommand* oldest() const { return commands_.empty() ? nullptr : &commands_.front(); }
  /// The same, which waits no more.
  std::optional<payload::JointCommand> take() {
    if (commands_.empty()) return std::nullopt;
    payload::JointCommand oldest = std::move(commands_.front());
    commands_.pop_front();
    return oldest;
  }
  std::size_t size() const { return commands_.size(); }
  void clear() { commands_.clear(); }

 private:
  using Joint = payload::JointCommand::Joint;
  static bool commands(const Joint& joint) { return joint.position || joint.velocity || joint.effort; }
  static bool says_nothing(const payload::JointCommand& command) {
    return std::none_of(command.joints.begin(), command.joints.end(), commands);
  }
  static unsigned take_out(payload::JointCommand& older, const payload::JointCommand& newer) {
    unsigned replaced = 0;
    for (std::size_t i = 0; i < std::min(older.joints.size(), newer.joints.size()); ++i) {
      if (!commands(older.joints[i]) || !commands(newer.joints[i])) continue;
      older.joints[i] = {};
      ++replaced;
    }
    return replaced;
  }

  std::deque<payload::JointCommand> commands_;  ///< the oldest first
};

}  // namespace limb_ring::bridge
