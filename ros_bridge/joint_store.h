#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "config/ring_config.h"
#include "limb_ring/payload/joint_state.h"

namespace limb_ring::bridge {

/// The newest state of every node's joints, and which of them can still be believed.
///
/// A node is silent when no state of it has come for three state periods, and for longer than the machine may pause a
/// process. Its joints are then listed as silent, and their last state is not shown. Time is an argument.
class JointStore {
 public:
  using Clock = std::chrono::steady_clock;

  struct Joint {
    std::string name;
    payload::JointState::Joint state;
  };
  struct Sample {
    std::uint8_t node;
    std::int64_t stamp_ns;
  };
  struct Snapshot {
    std::vector<Joint> fresh;          ///< in the configuration's order, then those that follow them
    std::int64_t oldest_stamp_ns = 0;  ///< of the samples in `fresh`; wall clock
    std::vector<Sample> samples;       ///< that `fresh` is made of
    std::vector<std::string> silent;   ///< joints left out
  };
  /// What has come from one node.
  struct Received {
    std::uint64_t states = 0;
    std::uint64_t missing = 0;  ///< left out in the sequence of states, restarts not counted
    std::uint64_t refused = 0;  ///< commands that its CPU did not obey, as its states count them
    bool stopped = false;       ///< a stop interrupt is latched there
  };

  explicit JointStore(const config::RingConfig& ring);

  /// @return false where the node is not configured, or has another number of joints.
  bool take(std::uint8_t node, const payload::JointState& state, Clock::time_point now);
  /// The connection to the ring was lost: every node is silent until its next state comes.
  void forget();
  /// @param pause for so long the machine may not run a process; 0 where the ring's time waits for all
  Snapshot snapshot(Clock::time_point now, Clock::duration pause = {}) const;
  Received received(std::uint8_t node) const;
  /// The node owns joints, and they are not silent.
  bool speaks(std::uint8_t node, Clock::time_point now, Clock::duration pause = {}) const;

 private:
  struct Node {
    std::vector<std::string> joints;
    bool heard = false;
    Clock::time_point arrived{};
    payload::JointState state;
    Received received;
  };
  bool is_fresh(const Node& node, Clock::time_point now, Clock::duration pause) const;
  void add_followers(Snapshot& snapshot) const;

  Clock::duration silence_;
  std::vector<std::uint8_t> order_;
  std::map<std::uint8_t, Node> nodes_;
  std::vector<config::FollowerConfig> followers_;
};

}  // namespace limb_ring::bridge
