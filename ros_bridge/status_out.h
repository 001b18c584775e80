#pragma once

#include <limb_ring/NodeStatus.h>
#include <limb_ring/RingStatus.h>
#include <ros/ros.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "ring/ring_client.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/events_out.h"
#include "ros_bridge/joint_data_out.h"

namespace limb_ring::bridge {

/// Notices restarted CPUs by comparing each beacon of their node with the one before. (ours)
class CpuBoots {
 public:
  /// @param node_boot of the node's daemon
  /// @param cpu_boots starts of the CPU since its daemon started; 0: not known, or not yet
  /// @return the CPU was started again since it was last known to have started
  bool take(std::uint8_t node, std::uint64_t node_boot, std::uint32_t cpu_boots) {
    if (cpu_boots == 0) return false;
    const Boots now{node_boot, cpu_boots};
    const auto [known, is_new] = last_.emplace(node, now);
    const Boots before = std::exchange(known->second, now);
    return !is_new && (before.cpu != now.cpu || is_another_daemon(before.node, now.node));
  }

 private:
  struct Boots {
    std::uint64_t node;
    std::uint32_t cpu;
  };
  /// The boot number of a daemon begins with the clock in ns and grows by one when the daemon starts over (protocol.md
  /// section 4.8). So two numbers that are close belong to the same process, whose CPU may have kept running.
  static bool is_another_daemon(std::uint64_t before, std::uint64_t now) {
    constexpr std::uint64_t kNear = 1000;
    return now > before ? now - before > kNear : before - now > kNear;
  }

  std::map<std::uint8_t, Boots> last_;
};

/// Asks the daemons of a ring for their status, as any tool may: that of the bridge's own node, and those of the other
/// nodes that run on this host. One thread.
class RingWatch {
 public:
  /// @param daemon how to reach the daemon of the bridge's own node: ring, node and runtime
  RingWatch(const config::RingConfig& ring, const ConnectOptions& daemon);

  /// States, CPUs and boots as text, from the bridge's own node and the beacons that it hears. The costlier poll() is
  /// needed only when this text has changed. Empty if the own daemon does not answer.
  std::string digest();
  /// All configured nodes, in ring order.
  std::vector<NodeStatus> poll();
  /// Nodes whose CPU has restarted since the last call, according to the beacons that the own node has heard.
  std::vector<std::uint8_t> take_restarted() { return std::exchange(restarted_, {}); }

 private:
  void notice_boots(const status::NodeRow& own);
  /// Says once what is wrong with an answer.
  void tell(std::size_t node, const ask::ToldRow& row);

  const config::RingConfig& ring_;
  ask::RingClient client_;
  std::size_t own_;                // place of the bridge's own node
  std::vector<std::string> told_;  // what was wrong with the last answer of each; empty: nothing
  CpuBoots boots_;
  std::vector<std::uint8_t> restarted_;
};

/// `ring_status`, latched: once a second, and at once when a node or CPU changes its state, a
/// joint falls silent, a stop is latched or ended, or the daemon goes; and `stopped`, latched, on change. A thread of
/// its own asks the daemons.
class StatusOut {
 public:
  /// The CPU of a node (by id) has restarted.
  using OnBoot = std::function<void(std::uint8_t node)>;

  using OnStatus = std::function<void(const RingStatus&)>;

  StatusOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const ConnectOptions& daemon, RingPort& port,
            const JointDataOut& joints, const EventsOut& events, const Counters& counters, OnBoot on_boot);
  ~StatusOut();
  /// Before start(): calls `handler` with every status that is published, from this class's thread.
  void on_status(OnStatus handler) { on_status_.push_back(std::move(handler)); }
  void start();

 private:
  /// What is published at once when it changes.
  struct Noticed {
    std::string digest;               ///< of the daemons' states
    std::vector<std::string> silent;  ///< joints
    std::vector<std::string> silent_sensors;
    std::string problem;               ///< of the bridge's own connection
    std::vector<std::string> stopped;  ///< nodes whose joint states say that a stop is latched

    bool operator!=(const Noticed& other) const {
      return std::tie(digest, silent, silent_sensors, problem, stopped) !=
             std::tie(other.digest, other.silent, other.silent_sensors, other.problem, other.stopped);
    }
  };

  void run();
  bool is_due();
  void publish();
  void fill_header(RingStatus& status);
  void fill_joints(NodeStatus& node) const;
  std::string problem();
  std::vector<std::string> stopped_nodes() const;
  void tell_stopped(const RingStatus& status);

  const config::RingConfig& ring_;
  std::string own_node_;
  const RosClock& clock_;
  RingWatch watch_;
  const JointDataOut& joints_;
  const EventsOut& events_;
  const Counters& counters_;
  OnBoot on_boot_;
  std::vector<OnStatus> on_status_;
  ros::Publisher publisher_, stopped_;

  Noticed noticed_;  ///< last
  std::chrono::steady_clock::time_point published_{};
  std::optional<bool> told_stopped_;

  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::string problem_ = "not connected yet";
  std::thread thread_;
};

}  // namespace limb_ring::bridge
