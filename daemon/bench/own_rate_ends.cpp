// own_rate_ends RATE SECONDS: both ends of a humanoid at its own rate, in ROS. Publishes joint_commands at RATE Hz,
// counts joint_states, asks ring_status which states were left out, and prints that as JSON.
#include <limb_ring/RingStatus.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

namespace {

/// Until the ring is closed, all joints are heard and the first commands are obeyed.
constexpr double kSettling = 2;

struct States {
  std::uint64_t received = 0, missing = 0;
};

class OwnRateEnds {
 public:
  OwnRateEnds(double rate, double seconds) : seconds_(seconds) {
    commands_ = nodes_.advertise<sensor_msgs::JointState>("joint_commands", 1);
    const auto no_delay = ros::TransportHints().tcpNoDelay();
    states_ = nodes_.subscribe("joint_states", 1000, &OwnRateEnds::on_states, this, no_delay);
    status_ = nodes_.subscribe("ring_status", 10, &OwnRateEnds::on_status, this, no_delay);
    timer_ = nodes_.createWallTimer(ros::WallDuration(1 / rate), &OwnRateEnds::command, this);
  }

  bool done() const { return done_; }
  nlohmann::json report() const {
    const double time = (ended_ - begun_).toSec();
    return {{"joint_states_rate", static_cast<double>(counted_) / time},
            {"samples", last_.received - first_.received + last_.missing - first_.missing},
            {"left_out", last_.missing - first_.missing},
            {"lap_p50_us", lap_p50_ * 1e6},
            {"lap_p99_us", lap_p99_ * 1e6}};
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
    if (!begun_.isZero()) ++counted_;
  }

  // From one status to another, each what the ring's nodes knew in that instant.
  void on_status(const limb_ring::RingStatus::ConstPtr& status) {
    const ros::WallTime now = ros::WallTime::now();
    if (pose_.name.empty() || !status->silent_joints.empty()) return;
    if (settled_.isZero()) settled_ = now + ros::WallDuration(kSettling);
    if (now < settled_ || done_) return;
    last_ = {};
    lap_p50_ = lap_p99_ = 0;
    for (const auto& node : status->nodes) {
      last_.received += node.states_received;
      last_.missing += node.states_missing;
      lap_p50_ = std::max(lap_p50_, node.round_trip_p50);
      lap_p99_ = std::max(lap_p99_, node.round_trip_p99);
    }
    ended_ = now;
    if (begun_.isZero()) {
      begun_ = ended_;
      first_ = last_;
      counted_ = 0;
    }
    done_ = (ended_ - begun_).toSec() >= seconds_;
  }

  double seconds_;
  ros::NodeHandle nodes_;
  ros::Publisher commands_;
  ros::Subscriber states_, status_;
  ros::WallTimer timer_;
  sensor_msgs::JointState pose_;
  ros::WallTime settled_, begun_, ended_;
  States first_, last_;
  std::uint64_t counted_ = 0;
  double lap_p50_ = 0, lap_p99_ = 0;  ///< s, of the node for which it is worst
  bool done_ = false;
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
