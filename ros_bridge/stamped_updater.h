#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/ros.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "ros_bridge/ros_clock.h"

namespace limb_ring::bridge {

/// diagnostic_updater::Updater goes by ROS time alone, which may be simulated, or stand still, while the ring is not;
/// here stamps are of the bridge's clock.
class StampedUpdater {
 public:
  using Task = std::function<void(diagnostic_updater::DiagnosticStatusWrapper&)>;

  /// @param prefix of the names, before ": "
  StampedUpdater(ros::NodeHandle& nodes, std::string prefix, std::string hardware_id, const RosClock& clock)
      : prefix_(std::move(prefix)),
        hardware_id_(std::move(hardware_id)),
        clock_(clock),
        publisher_(nodes.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1)) {}

  void add(const std::string& name, Task task) { tasks_.emplace_back(name, std::move(task)); }
  /// Publishes what all tasks say now.
  void update() {
    diagnostic_msgs::DiagnosticArray all;
    all.header.stamp = clock_.now();
    for (const auto& [name, task] : tasks_) {
      diagnostic_updater::DiagnosticStatusWrapper status;
      status.name = prefix_ + ": " + name;
      status.hardware_id = hardware_id_;
      task(status);
      all.status.push_back(status);
    }
    publisher_.publish(all);
  }

 private:
  const std::string prefix_, hardware_id_;
  const RosClock& clock_;
  ros::Publisher publisher_;
  std::vector<std::pair<std::string, Task>> tasks_;
};

}  // namespace limb_ring::bridge
