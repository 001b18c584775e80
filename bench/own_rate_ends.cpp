// own_rate_ends RATE SECONDS: both ends of a humanoid at its own rate, in ROS. Publishes joint_commands at RATE Hz,
// counts joint_states, asks ring_status which states were left out, and prints that as JSON.
#include <limb_ring/RingStatus.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench/measurement.h"

namespace {

/// Until the ring is closed, all joints are heard and the first commands are obeyed.
constexpr double kSettling = 2;

class OwnRateEnds {
 public:
  OwnRateEnds(double rate, double seconds) : span_(seconds) {
    commands_ = nodes_.advertise<sensor_msgs::JointState>("joint_commands", 1);
    const auto no_delay = ros::TransportHints().tcpNoDelay();
    states_ = nodes_.subscribe("joint_states", 1000, &OwnRateEnds::on_states, this, no_delay);
    status_ = nodes_.subscribe("ring_status", 10, &OwnRateEnds::on_status, this, no_delay);
    timer_ = nodes_.createWallTimer(ros::WallDuration(1 / rate), &OwnRateEnds::command, this);
  }

  bool done() const { return span_.done(); }
  nlohmann::json report() const {
    return {{"joint_states_rate", static_cast<double>(counted_) / span_.seconds()},
            {"commands_rate", span_.commands_each() / span_.seconds()},
            {"samples", span_.samples()},
            {"left_out", span_.left_out()},
            {"lap_p50_us", span_.lap_p50() * 1e6},
            {"lap_p99_us", span_.lap_p99() * 1e6}};
  }

 private:
  void command(const ros::WallTimerEvent&) {
    if (pose_.name.empty()) return;
    const auto now = ros::WallTime::now();
    pose_.header.stamp = ros::Time(now.sec, now.nsec);
    commands_.publish(pose_);
  }

  void on_states(const sensor_msgs::JointState::ConstPtr& states) {
    if (states->name.size() > pose_.name.size()) {
      pose_.name = states->name;
      pose_.position = states->position;
    }
    if (span_.begun()) ++counted_;
  }

  void on_status(const limb_ring::RingStatus::ConstPtr& status) {
    const ros::WallTime now = ros::WallTime::now();
    if (pose_.name.empty() || !status->silent_joints.empty()) return;
    if (settled_.isZero()) settled_ = now + ros::WallDuration(kSettling);
    if (now >= settled_) span_.take(*status, now);
  }

  ros::NodeHandle nodes_;
  ros::Publisher commands_;
  ros::Subscriber states_, status_;
  ros::WallTimer timer_;
  sensor_msgs::JointState pose_;
  ros::WallTime settled_;
  limb_ring::bench::StatusSpan span_;
  std::uint64_t counted_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "own_rate_ends");
  if (argc != 3) {
    std::cerr << "own_rate_ends RATE SECONDS\n";
    return 2;
  }
  OwnRateEnds ends(std::strtod(argv[1], nullptr), std::strtod(argv[2], nullptr));
  while (ros::ok() && !ends.done()) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  std::cout << ends.report() << std::endl;
  return ends.done() ? 0 : 1;
}
