#include "ros_bridge/two_names.h"

#include <ros/master.h>
#include <ros/this_node.h>

#include <utility>

namespace limb_ring::bridge {

TwoNames::TwoNames(const ros::NodeHandle& nodes) : short_(nodes), own_("~") {
  if (auto state = master_state()) providers_ = std::move(state->services);
  own_.setCallbackQueue(short_.getCallbackQueue());
}

bool TwoNames::belongs_to_another(const std::string& name) {
  const std::string full = short_.resolveName(name);
  const MasterState::Nodes providers = MasterState::of(providers_, full);
  if (providers.empty() || providers.count(ros::this_node::getName()) != 0) return false;
  if (!ros::service::exists(full, /*print_failure_reason=*/false)) return false;  // what a dead node has left behind
  ROS_WARN("service %s belongs to node %s; this bridge offers %s", full.c_str(), providers.begin()->c_str(),
           own_.resolveName(name).c_str());
  return true;
}

void TwoNames::shutdown() {
  for (auto& server : servers_) server.shutdown();
}

namespace {

using XmlRpc::XmlRpcValue;

/// Of a list [[name, [node, ...]], ...].
MasterState::ByName by_name(XmlRpcValue& list) {
  MasterState::ByName all;
  for (int i = 0; i < list.size(); ++i) {
    MasterState::Nodes& nodes = all[list[i][0]];
    for (int n = 0; n < list[i][1].size(); ++n) nodes.insert(std::string(list[i][1][n]));
  }
  return all;
}

}  // namespace

std::optional<MasterState> master_state() {
  XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, /*wait_for_master=*/false)) return {};
  if (state.getType() != XmlRpcValue::TypeArray || state.size() < 3) return {};
  return MasterState{by_name(state[0]), by_name(state[1]), by_name(state[2])};
}

}  // namespace limb_ring::bridge
