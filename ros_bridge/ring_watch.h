#pragma once

#include <limb_ring/NodeStatus.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/host_port.h"
#include "ros_bridge/cpu_boots.h"

namespace limb_ring::bridge {

/// Asks the daemons of a ring how they are, as any tool may: its own node's in any case, and
/// those of the others that run on this host. One thread.
class RingWatch {
 public:
  /// `daemon` says how to reach the daemon of the bridge's own node; its role is ignored.
  RingWatch(const config::RingConfig& ring, const ConnectOptions& daemon);

  /// States, CPUs and boots as text, as told by the own node and the beacons that it hears. The costlier poll() is
  /// needed only when this has changed. Empty if the own daemon does not answer.
  std::string digest();
  /// All configured nodes, in ring order.
  std::vector<NodeStatus> poll();
  /// Nodes whose CPU was started again, by the beacons that the own node has heard: since the last call.
  std::vector<std::uint8_t> take_restarted() { return std::exchange(restarted_, {}); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Peer {
    std::optional<HostPort> port;
    Clock::time_point next_try{};
    std::string told;  ///< what was wrong with its last answer; empty: nothing
  };
  void notice_boots(const nlohmann::json& own);
  bool is_frozen(const std::string& node) const;
  std::optional<nlohmann::json> ask(const std::string& node);
  /// Says once what is wrong with the answer.
  static bool is_right(const nlohmann::json& row, const std::string& node, Peer& peer);

  const config::RingConfig& ring_;
  ConnectOptions daemon_;
  std::map<std::string, Peer> peers_;  // by name
  CpuBoots boots_;
  std::vector<std::uint8_t> restarted_;
};

}  // namespace limb_ring::bridge
