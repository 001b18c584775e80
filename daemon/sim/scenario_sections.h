#pragma once

#include "config/fault_parse.h"
#include "config/option.h"
#include "sim/scenario.h"

namespace limb_ring::scenario {

/// What the maps of a scenario may hold.
const config::Section<Scenario>& scenario_section();
const config::Section<Step>& step_section();

/// `{KIND: ..., ...}`: a condition. @throw config::ConfigError
Condition read_condition(const config::Entry& entry);
/// `{FAULT: ...}`, `{send: {...}}` or an action of the soak's world, into the step. @throw config::ConfigError
void read_action(const config::Entry& entry, Step& step);

/// The rate (bit/s, not unlimited) and the relay delay d of lines for which the ring's file gives no rate.
std::uint64_t read_line_rate(const config::Entry& entry);
nanoseconds read_relay_delay(const config::Entry& entry);

/// Reads the entry alone, without anything else of the file.
World read_world(const config::Entry& entry);
config::RingConfig::Redundancy read_redundancy(const config::Entry& entry);

/// A node, a list of nodes, or `all`. @throw config::ConfigError
std::vector<NodeId> read_nodes(const config::Entry& entry);
/// One node, by its place in ring order. @throw config::ConfigError
inline NodeId read_place(const config::Entry& entry, const std::string& also = "") {
  return NodeId{config::read_node(entry, also)};
}
/// `{sim: TIME, live: TIME}`, or a time: live it is kLiveGuard longer. @throw config::ConfigError
Limit read_limit(const config::Entry& entry);
/// `A -> B`, two nodes that follow each other in the ring. @throw config::ConfigError
Located read_line(const config::Entry& entry);

/// `{wire: {cut: A -> B}}` and its like; nothing if it is none of them. @throw config::ConfigError
std::optional<SoakAction> read_soak_action(const config::Member& action, const fault::RingNodes& nodes);
/// All keys that read_soak_action() knows.
std::vector<std::string> soak_words();

}  // namespace limb_ring::scenario
