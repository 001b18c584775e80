#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <limb_ring/RingStatus.h>

#include <chrono>
#include <string>

#include "config/ring_config.h"
#include "ros_bridge/counter_growth.h"
#include "ros_bridge/recent.h"

namespace limb_ring::bridge {

/// The condition of the line from one node to the next. (ours)
///   STALE  neither end is known (on another host, or not running), nor a break there
///   ERROR  broken, as one of its ends or the node behind the break says
///   WARN   bypassed: one of its ends leads elsewhere; or something was wrong within kWarnFor
class LineHealth {
 public:
  using Clock = std::chrono::steady_clock;

  LineHealth(const config::NodeConfig& from, const config::NodeConfig& to);

  std::string name() const { return "line " + from_.name + " -> " + to_.name; }
  void take(const RingStatus& ring, Clock::time_point now);
  void tell(diagnostic_updater::DiagnosticStatusWrapper& out, Clock::time_point now);

 private:
  struct Finding {
    unsigned char level;
    std::string text;
  };
  Finding finding() const;
  void note_growth(CounterGrowth& counters, const NodeStatus& node, Clock::time_point now);

  const config::NodeConfig& from_;
  const config::NodeConfig& to_;
  NodeStatus before_, behind_;  // the nodes at its ends
  bool said_broken_ = false;
  CounterGrowth out_counters_, in_counters_;
  Recent recent_;
};

}  // namespace limb_ring::bridge
