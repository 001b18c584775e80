#pragma once

#include <limb_ring/Resume.h>

#include <chrono>
#include <cstdint>
#include <future>
#include <vector>

#include "config/ring_config.h"
#include "ring/resumed.h"
#include "ros_bridge/command_in.h"
#include "ros_bridge/ring_port.h"
#include "ros_bridge/two_names.h"

namespace limb_ring::bridge {

/// `resume`: ends the stop that is latched at a node, or at all. The bridge sends it as it sends commands; where that
/// does not reach a node, another node of this host does.
class ResumeService {
 public:
  /// @param daemon the bridge's, as a tool connects to it
  ResumeService(TwoNames& names, const config::RingConfig& ring, ConnectOptions daemon, RingPort& port,
                CommandIn& commands);

 private:
  bool resume(Resume::Request& request, Resume::Response& response);
  /// Of these, the ones with joints, and those on this host that say that a stop is latched.
  std::vector<ask::Resumed> nodes_to_resume(std::uint8_t destination) const;
  std::future<Result> resume_from_bridge(std::uint8_t node);
  /// @throw HostPortError
  Result resume_from(std::uint8_t sender, std::uint8_t node, std::chrono::milliseconds timeout) const;

  const config::RingConfig& ring_;
  ConnectOptions daemon_;
  RingPort& port_;  ///< its time goes on during a call
  CommandIn& commands_;
};

}  // namespace limb_ring::bridge
