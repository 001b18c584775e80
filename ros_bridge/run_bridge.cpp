#include "ros_bridge/run_bridge.h"

#include "ros_bridge/bridge.h"

namespace limb_ring::bridge {
namespace {

void keep_parameters(const ros::NodeHandle& own, const KeptText& kept) {
  XmlRpc::XmlRpcValue given;
  if (ros::param::get(own.getNamespace(), given) && given.hasMember("config")) return kept.put(given.toXml());
  const std::string before = kept.get();
  if (before.empty()) return;  // its first life
  int offset = 0;
  XmlRpc::XmlRpcValue known(before, &offset);
  if (known.getType() != XmlRpc::XmlRpcValue::TypeStruct) return;
  for (auto& [name, value] : known) own.setParam(name, value);
  ROS_WARN("the ROS master is new, and did not know this node's parameters: those of before are set again");
}

}  // namespace

void run_bridge(const KeptText& kept) {
  const ros::NodeHandle own("~");
  keep_parameters(own, kept);
  const Bridge bridge(ros::NodeHandle(), read_parameters(own));
  ros::spin();
}

}  // namespace limb_ring::bridge
