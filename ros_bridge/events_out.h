#pragma once

#include <limb_ring/RingEvent.h>
#include <ros/ros.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "config/ring_config.h"
#include "ros_bridge/counters.h"
#include "ros_bridge/ring_listener.h"
#include "ros_bridge/ros_clock.h"

namespace limb_ring::bridge {

/// Turns what daemons tell an observer (docs/reference/requests.md) into typed events. Two of them concern the
/// whole ring and are derived from the reports of all daemons: a fault located, the ring healed. Events that no daemon
/// reported are found in the status rows: those before the observation began, and a further line that breaks.
class EventConversion {
 public:
  explicit EventConversion(const config::RingConfig& ring) : ring_(ring) {}

  /// The events in one line of `node`'s daemon, in order; none if it is not an event of these kinds.
  std::vector<RingEvent> events_of(const config::NodeConfig& node, const std::string& line);
  /// The events that the status row of `node`'s daemon shows and no daemon has reported; none if it is not a status
  /// row. They have no stamp.
  std::vector<RingEvent> events_of_row(const config::NodeConfig& node, const std::string& row);
  /// The daemon of a node is gone: nothing is known of its part of the ring any more. The event has no stamp.
  RingEvent gone(const config::NodeConfig& node);
  /// The node was in an open chain, or folded, when last heard of: further lines may break.
  bool is_open(const config::NodeConfig& node) const { return open_.count(node.id) != 0; }

 private:
  std::string name_of(int id) const;
  void take_link(const nlohmann::json& said, RingEvent& event) const;
  void take_pin(const nlohmann::json& said, const config::NodeConfig& node, RingEvent& event) const;
  /// @param said of its state, as an observer is told
  std::vector<RingEvent> take_state(const nlohmann::json& said, const config::NodeConfig& node);
  std::vector<RingEvent> take_cpu(const nlohmann::json& said, const config::NodeConfig& node);
  std::optional<RingEvent> fault_of(const nlohmann::json& said);
  std::vector<RingEvent> cures_of(const nlohmann::json& said, const config::NodeConfig& node);

  struct Line {
    int before, behind;
    bool operator<(const Line& other) const { return std::tie(before, behind) < std::tie(other.before, other.behind); }
  };
  /// What was told last of a node.
  struct Told {
    std::string state;
    std::pair<std::string, std::int64_t> cpu;  ///< state and boots
  };
  const config::RingConfig& ring_;
  std::set<Line> broken_;        // since the ring was last closed
  std::set<std::uint8_t> open_;  // nodes in an open chain, or folded
  std::map<std::uint8_t, Told> told_;
};

/// `ring_events`: what happens at the nodes of this host, as their daemons see it. The daemons are observed all the
/// time, since events are rare: a subscriber misses only what happened before it subscribed.
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
