#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/ros.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "io/throttle.h"
#include "limb_ring/host_port.h"
#include "ring/observed_daemon.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/health.h"
#include "ros_bridge/ros_clock.h"
#include "ros_bridge/topic_in.h"

namespace limb_ring::bridge {

/// The bridge's own losses, for diagnostics: each counter of a loss that grows is a warning for kWarnFor. (ours)
class BridgeLosses {
 public:
  using Clock = std::chrono::steady_clock;

  BridgeLosses();

  void take(const Counters::Values& losses, Clock::time_point now);
  /// To be called after everything else that adds to the summary.
  void tell(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now);

 private:
  Counters::Values last_;
  Recent recent_;
};

/// Judges the ring's promises, as `ringctl traffic judge` does, for `/diagnostics`: "promises". A thread of its own.
class PromisesOut {
 public:
  PromisesOut(const config::RingConfig& ring, const ConnectOptions& daemon);
  ~PromisesOut();
  PromisesOut(const PromisesOut&) = delete;
  PromisesOut& operator=(const PromisesOut&) = delete;

  /// OK, or ERROR once one was broken, with counts and the last one. May be called by any thread.
  void tell(diagnostic_updater::DiagnosticStatusWrapper& out) const;

 private:
  void run();

  process::Throttle told_{std::chrono::seconds(1)};  // the thread's alone, as the next
  live::PromiseWatch watch_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  promises::JudgeCounts counts_;
  std::size_t watched_ = 0;
  std::string last_, problem_;
  std::thread thread_;
};

/// diagnostic_updater::Updater uses only ROS time, which may be simulated, or stand still, while the ring runs in real
/// time. Here the stamps are of the bridge's clock.
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

/// `/diagnostics`: the ring, every node and every line of it, as `limb_ring: NAME` (behind the
/// namespace, if there is one); hardware id: the ring's name. One thread.
class DiagnosticsOut {
 public:
  DiagnosticsOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const Counters& counters,
                 const RosClock& clock);

  /// From now on "promises" is reported, too. `promises` must outlive this. Call it before the first take().
  void add(const PromisesOut& promises);
  /// Publishes what the status says, together with what was wrong lately.
  void take(const RingStatus& status);

 private:
  void tell_bridge(diagnostic_updater::DiagnosticStatusWrapper& out);

  const Counters& counters_;
  RingStatus status_;
  BridgeLosses losses_;
  std::deque<NodeHealth> nodes_;  // a deque: the updater's tasks hold on to them
  std::deque<LineHealth> lines_;
  StampedUpdater updater_;
};

}  // namespace limb_ring::bridge
