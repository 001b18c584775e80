#pragma once

#include <ros/ros.h>

#include <optional>
#include <string>
#include <vector>

#include "ros_bridge/command_in.h"
#include "ros_bridge/joint_data_out.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/ros_links.h"

namespace limb_ring::bridge {

/// The controllers that a virtual ring's time waits for (`bridge: {lockstep}`), one for each topic of joint commands.
/// After each joint_states, time stands until all have answered. A controller that does not is named in a warning, and
/// is not waited for again until its next command. Ring thread only.
class Controllers {
 public:
  /// All outlive this. Before the port starts.
  Controllers(const config::RingConfig& ring, RingPort& port, JointDataOut& joints, CommandIn& commands);

 private:
  struct Controller {
    std::string topic;
    std::string name;  ///< of the ROS node that was heard last; empty: none yet
    bool missing = false;
    bool answered = false;
    std::optional<ros::Time> too_old;  ///< stamp of a command that has come instead of an answer
  };
  void await_first();
  bool are_there();
  void await_answers(ros::Time stamp);
  void on_command(const CommandIn::Heard& command);
  bool has_answered(const Controller& controller) const;
  bool has_gone(const Controller& controller) const;
  std::string topics() const;
  void give_up(Controller& controller, std::chrono::milliseconds patience);

  std::chrono::milliseconds patience_;
  RingPort& port_;
  JointDataOut& joints_;
  CommandIn& commands_;
  RosLinks links_;
  std::vector<Controller> controllers_;
  ros::Time awaited_;  ///< stamp of the joint_states that were published last
  bool awaited_first_ = false;
  bool told_ = false;  ///< that time stands
};

}  // namespace limb_ring::bridge
