#pragma once

#include <limb_ring/RingEvent.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "config/ring_config.h"

namespace limb_ring::bridge {

/// Turns what daemons tell an observer (daemon/host/requests.md) into typed events. Two of them concern the
/// whole ring and are derived from the reports of all daemons: a fault located, the ring healed.
class EventConversion {
 public:
  explicit EventConversion(const config::RingConfig& ring) : ring_(ring) {}

  /// The events in one line of `node`'s daemon, in order; none where it is no event of these kinds.
  std::vector<RingEvent> events_of(const config::NodeConfig& node, const std::string& line);
  /// The daemon of a node is gone: nothing is known of its part of the ring any more.
  void forget(const config::NodeConfig& node) { open_.erase(node.id); }

 private:
  std::string name_of(int id) const;
  void take_link(const std::string& what, RingEvent& event) const;
  void take_pin(const nlohmann::json& said, const config::NodeConfig& node, RingEvent& event) const;
  std::optional<RingEvent> fault_of(const nlohmann::json& said);
  std::optional<RingEvent> cure_of(const nlohmann::json& said, const config::NodeConfig& node);

  struct Line {
    int before, behind;
    bool operator==(const Line& other) const { return before == other.before && behind == other.behind; }
  };
  const config::RingConfig& ring_;
  std::optional<Line> broken_;
  std::set<std::uint8_t> open_;  // nodes in an open chain, or folded
};

}  // namespace limb_ring::bridge
