#include "ros_bridge/master_state.h"

#include <ros/master.h>
#include <ros/this_node.h>

namespace limb_ring::bridge {
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
