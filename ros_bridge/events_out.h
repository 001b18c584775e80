#pragma once

#include <ros/ros.h>

#include "ros_bridge/counters.h"
#include "ros_bridge/event_conversion.h"
#include "ros_bridge/ring_listener.h"
#include "ros_bridge/ros_clock.h"

namespace limb_ring::bridge {

/// `ring_events`: what happens at the nodes of this host, as their daemons see it. The daemons are observed all
/// the time, since events are rare: a subscriber misses only what was before it came.
class EventsOut {
 public:
  EventsOut(ros::NodeHandle& nodes, const config::RingConfig& ring, const ConnectOptions& daemon, Counters& counters,
            const RosClock& clock);
  /// Whether the events of the node with this id are heard here, as of now. From any thread.
  bool hears(std::uint8_t node) const { return listener_.hears(node); }

 private:
  void take(const config::NodeConfig& node, const Message& message);
  void publish_now(RingEvent event);

  Counters& counters_;
  const RosClock& clock_;
  EventConversion conversion_;
  ros::Publisher publisher_;
  RingListener listener_;  // last: its thread uses the others
};

}  // namespace limb_ring::bridge
