#pragma once

#include <string>

namespace limb_ring::bridge {

/// Names of frames as tf is to know them: behind the parameter `tf_prefix`, where one is set in this node's namespace
/// or above, as robot_state_publisher has it. So two robots of one URDF have frames of their own.
class FrameNames {
 public:
  /// Asks the parameter server.
  FrameNames();
  std::string of(const std::string& frame) const { return prefix_.empty() ? frame : prefix_ + '/' + frame; }

 private:
  std::string prefix_;
};

}  // namespace limb_ring::bridge
