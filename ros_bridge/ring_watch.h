#pragma once

#include <limb_ring/NodeStatus.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/host_port.h"

namespace limb_ring::bridge {

/// Asks the daemons of a ring how they are, as any tool may: its own node's in any case, and
/// those of the others that run on this host. One thread.
class RingWatch {
 public:
  /// `daemon` says how to reach the daemon of the bridge's own node; its role is ignored.
  RingWatch(const config::RingConfig& ring, const ConnectOptions& daemon);

  /// What the own node and the beacons that it hears tell about states, CPUs and boots, as text: poll() is worth its
  /// cost only where this has changed. Empty where the own daemon is silent.
  std::string digest();
  /// All configured nodes, in ring order.
  std::vector<NodeStatus> poll();

 private:
  using Clock = std::chrono::steady_clock;
  struct Peer {
    std::optional<HostPort> port;
    Clock::time_point next_try{};
  };
  std::optional<nlohmann::json> ask(const std::string& node);

  const config::RingConfig& ring_;
  ConnectOptions daemon_;
  std::map<std::string, Peer> peers_;  // by name
};

}  // namespace limb_ring::bridge
