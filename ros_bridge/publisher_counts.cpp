#include "ros_bridge/publisher_counts.h"

#include <ros/master.h>
#include <ros/this_node.h>

namespace limb_ring::bridge {

std::map<std::string, unsigned> publisher_counts() {
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, /*wait_for_master=*/false)) return {};
  std::map<std::string, unsigned> counts;
  XmlRpc::XmlRpcValue& topics = state[0];  // each as [name, [node, ...]]
  for (int i = 0; i < topics.size(); ++i) counts[topics[i][0]] = static_cast<unsigned>(topics[i][1].size());
  return counts;
}

}  // namespace limb_ring::bridge
