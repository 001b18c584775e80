#include "ros_bridge/ros_links.h"

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpc.h>

#include <cstdint>
#include <optional>

#include "ros_bridge/master_state.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using XmlRpc::XmlRpcValue;
using RosNodes = MasterState::Nodes;

constexpr auto kLinksAnswer = 500ms;
constexpr auto kSubscribesWithin = 1s;
constexpr double kLinksLook = 0.01;

/// A call that ends: XmlRpcClient's own waits for as long as the other end takes.
class TimedCall : public XmlRpc::XmlRpcClient {
 public:
  using XmlRpcClient::XmlRpcClient;
  bool get(const char* method, const XmlRpcValue& request, XmlRpcValue& answer) {
    const auto deadline = steady_clock::now() + kLinksAnswer;
    if (!executeNonBlock(method, request)) return false;
    while (!executeCheckDone(answer)) {
      if (steady_clock::now() >= deadline) return false;
      _disp.work(kLinksLook);
    }
    return !isFault() && answer.getType() == XmlRpcValue::TypeArray && answer.size() == 3;
  }
};

bool ask_master(const char* method, const XmlRpcValue& request, XmlRpcValue& answer) {
  XmlRpcValue response;
  return ros::master::execute(method, request, response, answer, false);
}

RosNodes without_this(RosNodes nodes) {
  nodes.erase(ros::this_node::getName());
  return nodes;
}

/// The nodes at the other end of what a node publishes on a topic, as it says itself; nothing where it does not answer.
std::optional<RosNodes> nodes_reached_by(const std::string& node, const std::string& topic) {
  XmlRpcValue request, uri, own, answer;
  request[0] = ros::this_node::getName();
  request[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ask_master("lookupNode", request, uri) || !ros::network::splitURI(std::string(uri), host, port)) return {};
  own[0] = ros::this_node::getName();
  TimedCall call(host.c_str(), static_cast<int>(port), "/");
  if (!call.get("getBusInfo", own, answer)) return {};
  XmlRpcValue links = answer[2];  // [[connection, node, "o", transport, topic, ...] ...]
  RosNodes nodes;
  for (int i = 0; i < links.size(); ++i)
    if (links[i].size() > 4 && links[i][1].getType() == XmlRpcValue::TypeString && std::string(links[i][2]) == "o" &&
        std::string(links[i][4]) == topic)
      nodes.insert(std::string(links[i][1]));
  return nodes;
}

}  // namespace

bool RosLinks::is_patient_with(const std::string& node) {
  const auto since = seen_.emplace(node, steady_clock::now()).first->second;
  return steady_clock::now() - since < kSubscribesWithin;
}

bool RosLinks::answers_arrive(const std::string& heard, const std::string& answered) {
  const auto state = master_state();
  if (!state) return false;
  const std::string& own = ros::this_node::getName();
  const RosNodes subscribed = without_this(MasterState::of(state->subscribers, heard));
  const RosNodes hearing = nodes_reached_by(own, heard).value_or(RosNodes{});
  unsigned there = 0;
  for (const std::string& node : without_this(MasterState::of(state->publishers, answered))) {
    const auto reached = nodes_reached_by(node, answered);
    if (!reached) continue;  // it has ended without telling the master
    if (reached->count(own) == 0) return false;
    if (hearing.count(node) == 0 && (subscribed.count(node) != 0 || is_patient_with(node))) return false;
    ++there;
  }
  return there != 0;
}

}  // namespace limb_ring::bridge
