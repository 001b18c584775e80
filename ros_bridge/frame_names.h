#pragma once

#include <string>

namespace limb_ring::bridge {

/// Names of frames for tf: with the parameter `tf_prefix` in front, if it is set in this node's namespace or above, as
/// in robot_state_publisher. So two robots with the same URDF have frames of their own.
class FrameNames {
 public:
  /// Asks the parameter server.
  FrameNames();
  std::string of(const std::string& frame) const { return prefix_.empty() ? frame : prefix_ + '/' + frame; }

 private:
  std::string prefix_;
};

}  // namespace limb_ring::bridge
