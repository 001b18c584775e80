#include "ros_bridge/two_names.h"

namespace limb_ring::bridge {
namespace {

/// By full names. Empty where the master does not answer.
std::map<std::string, std::string> providers_of_services() {
  std::map<std::string, std::string> nodes;
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, /*wait_for_master=*/true)) return nodes;
  XmlRpc::XmlRpcValue& services = state[2];  // each as [name, [node, ...]]
  for (int i = 0; i < services.size(); ++i)
    if (services[i][1].size() > 0) nodes[services[i][0]] = std::string(services[i][1][0]);
  return nodes;
}

}  // namespace

TwoNames::TwoNames(const ros::NodeHandle& nodes) : short_(nodes), own_("~"), providers_(providers_of_services()) {
  own_.setCallbackQueue(short_.getCallbackQueue());
}

bool TwoNames::belongs_to_another(const std::string& name) {
  const std::string full = short_.resolveName(name);
  const auto provider = providers_.find(full);
  if (provider == providers_.end() || provider->second == ros::this_node::getName()) return false;
  if (!ros::service::exists(full, /*print_failure_reason=*/false)) return false;  // what a dead node has left behind
  ROS_WARN("service %s is that of node %s; this bridge's is %s", full.c_str(), provider->second.c_str(),
           own_.resolveName(name).c_str());
  return true;
}

void TwoNames::shutdown() {
  for (auto& server : servers_) server.shutdown();
}

}  // namespace limb_ring::bridge
