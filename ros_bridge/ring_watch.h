#pragma once

#include <limb_ring/NodeStatus.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "ring/ring_client.h"

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

}  // namespace limb_ring::bridge
