// walk: publishes joint_commands of a humanoid walking in place.
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include "config/load_ring.h"
#include "ros_bridge/gait.h"
#include "ros_bridge/node_main.h"
#include "ros_bridge/parameters.h"

namespace {

constexpr double kUsualRate = 100.0;  ///< Hz

constexpr const char* kHelp =
    "walk: publishes joint_commands of the humanoid walking in place. Usually started by demo.launch.\n"
    "Parameters: ~config: YAML file of the ring; ~step: s for a left and a right step, 0.8 to 10;\n"
    "~rate: Hz of joint_commands, 0.01 to 1000, 0: 100\n";

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
  using namespace limb_ring::bridge;
  const Gait gait(limb_ring::config::load_ring(config_parameter(own)),
                  number_parameter("step", given_parameter(own, "step"), 1.6));
  auto commands = nodes.advertise<sensor_msgs::JointState>("joint_commands", 1);
  const ros::WallDuration period(1.0 / rate_parameter(given_parameter(own, "rate"), kUsualRate));
  const auto start = ros::SteadyTime::now();
  const auto timer = nodes.createSteadyTimer(period, [&](const ros::SteadyTimerEvent&) {
    commands.publish(command_at(gait, ros::SteadyTime::now() - start));
  });
  ros::spin();
}

}  // namespace

int main(int argc, char** argv) { return limb_ring::bridge::run_node(argc, argv, {"walk", kHelp, walk}); }
