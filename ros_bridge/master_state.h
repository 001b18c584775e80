#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

namespace limb_ring::bridge {

/// What the ROS master knows: by full names, the nodes of each topic and service, also those that have died without
/// telling it.
struct MasterState {
  using Nodes = std::set<std::string>;
  using ByName = std::map<std::string, Nodes>;
  ByName publishers, subscribers, services;

  /// None where nobody has it.
  static Nodes of(const ByName& all, const std::string& name) {
    const auto found = all.find(name);
    return found == all.end() ? Nodes{} : found->second;
  }
};

/// Nothing where the master does not answer; one that is gone is not waited for.
std::optional<MasterState> master_state();

}  // namespace limb_ring::bridge
