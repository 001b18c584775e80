// walk: publishes joint_commands of a humanoid walking in place, by the wall clock.
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <exception>

#include "config/load_ring.h"
#include "ros_bridge/gait.h"

namespace {

const ros::WallDuration kPeriod{0.01};

sensor_msgs::JointState command_at(const limb_ring::bridge::Gait& gait, ros::WallDuration time) {
  sensor_msgs::JointState command;
  const auto now = ros::WallTime::now();
  command.header.stamp = ros::Time(now.sec, now.nsec);
  for (const auto& target : gait.at(time.toSec())) {
    command.name.push_back(target.joint);
    command.position.push_back(target.position);
  }
  return command;
}

void walk() {
  ros::NodeHandle nodes, own("~");
  const limb_ring::bridge::Gait gait(
      limb_ring::config::load_ring(own.param("config", std::string())), own.param("step", 1.6));
  auto commands = nodes.advertise<sensor_msgs::JointState>("joint_commands", 1);
  const auto start = ros::WallTime::now();
  const auto timer = nodes.createWallTimer(kPeriod, [&](const ros::WallTimerEvent&) {
    commands.publish(command_at(gait, ros::WallTime::now() - start));
  });
  ros::spin();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "walk");
  try {
    walk();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
