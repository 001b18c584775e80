// own_rate_ends RATE SECONDS: both ends of a humanoid at its own rate, in ROS. Publishes joint_commands at RATE Hz,
// counts joint_states, asks ring_status which states were left out, and prints that as JSON.
#include <limb_ring/RingStatus.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

namespace {

using Clock = std::chrono::steady_clock;

/// Until the ring is closed, all joints are heard and the first commands are obeyed.
constexpr std::chrono::seconds kSettling{2};

/// From one ring_status to another, each what the ring's nodes knew in that instant: how long that is, and what they
/// counted meanwhile.
class StatusSpan {
 public:
  /// @param seconds it is so long at least
  explicit StatusSpan(double seconds) : seconds_(seconds) {}

  void take(const limb_ring::RingStatus& status, Clock::time_point now) {
    if (done()) return;
    last_ = counts_of(status);
    if (!begun()) {
      begun_ = now;
      first_ = last_;
    }
    ended_ = now;
  }

  bool begun() const { return begun_.has_value(); }
  bool done() const { return begun() && seconds() >= seconds_; }
  double seconds() const { return std::chrono::duration<double>(ended_ - begun_.value_or(ended_)).count(); }
  /// Joint states that the nodes' CPUs sent, and of those the ones that did not come.
  std::uint64_t samples() const { return last_.received - first_.received + left_out(); }
  std::uint64_t left_out() const { return last_.missing - first_.missing; }
  /// Commands that each node with joints has taken, on average.
  double commands_each() const {
    if (last_.nodes == 0) return 0;
    return static_cast<double>(last_.commands - first_.commands) / static_cast<double>(last_.nodes);
  }
  /// s, at the end, of the node for which it is worst
  double lap_p50() const { return last_.lap_p50; }
  double lap_p99() const { return last_.lap_p99; }

 private:
  struct Counts {
    std::uint64_t received = 0, missing = 0;
    std::uint64_t commands = 0, nodes = 0;
    double lap_p50 = 0, lap_p99 = 0;
  };

  static Counts counts_of(const limb_ring::RingStatus& status) {
    Counts counts;
    for (std::size_t i = 0; i < status.counter_names.size(); ++i)
      if (status.counter_names[i] == "commands_delivered") counts.commands = status.counter_values[i];
    for (const auto& node : status.nodes) {
      counts.nodes += node.states_received != 0;
      counts.received += node.states_received;
      counts.missing += node.states_missing;
      counts.lap_p50 = std::max(counts.lap_p50, node.round_trip_p50);
      counts.lap_p99 = std::max(counts.lap_p99, node.round_trip_p99);
    }
    return counts;
  }

  double seconds_;
  std::optional<Clock::time_point> begun_;
  Clock::time_point ended_;
  Counts first_, last_;
};

class OwnRateEnds {
 public:
  OwnRateEnds(double rate, double seconds) : span_(seconds) {
    commands_ = nodes_.advertise<sensor_msgs::JointState>("joint_commands", 1);
    const auto no_delay = ros::TransportHints().tcpNoDelay();
    states_ = nodes_.subscribe("joint_states", 1000, &OwnRateEnds::on_states, this, no_delay);
    status_ = nodes_.subscribe("ring_status", 10, &OwnRateEnds::on_status, this, no_delay);
    timer_ = nodes_.createSteadyTimer(ros::WallDuration(1 / rate), &OwnRateEnds::command, this);
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
  void command(const ros::SteadyTimerEvent&) {
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
    const Clock::time_point now = Clock::now();
    if (pose_.name.empty() || !status->silent_joints.empty()) return;
    if (!settled_) settled_ = now + kSettling;
    if (now >= *settled_) span_.take(*status, now);
  }

  ros::NodeHandle nodes_;
  ros::Publisher commands_;
  ros::Subscriber states_, status_;
  ros::SteadyTimer timer_;
  sensor_msgs::JointState pose_;
  std::optional<Clock::time_point> settled_;
  StatusSpan span_;
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
