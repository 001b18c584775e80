#include "ros_bridge/two_names.h"

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
  ROS_WARN("service %s is that of node %s; this bridge's is %s", full.c_str(), providers.begin()->c_str(),
           own_.resolveName(name).c_str());
  return true;
}

void TwoNames::shutdown() {
  for (auto& server : servers_) server.shutdown();
}

}  // namespace limb_ring::bridge
