#include "ros_bridge/ros_links.h"

#include <ros/init.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpc.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

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

namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using RosNodes = MasterState::Nodes;

constexpr auto kLinksAnswer = 500ms;
constexpr auto kSubscribesWithin = 1s;
constexpr double kLinksLook = 0.01;
constexpr auto kUnlinkedLook = 10ms;  // a node tells nobody that it has noticed the end of a connection

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

/// One connection of a node, as it says itself.
struct Link {
  std::string other;  ///< of one that goes out: the node that hears it; of one that comes in: the publisher's URI
  std::string direction, topic;
};

/// Nothing if the node does not answer.
std::optional<std::vector<Link>> links_of(const std::string& node) {
  XmlRpcValue request, uri, own, answer;
  request[0] = ros::this_node::getName();
  request[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ask_master("lookupNode", request, uri) || !ros::network::splitURI(std::string(uri), host, port)) return {};
  own[0] = ros::this_node::getName();
  TimedCall call(host.c_str(), static_cast<int>(port), "/");
  if (!call.get("getBusInfo", own, answer)) return {};
  XmlRpcValue links = answer[2];  // [[connection, node or URI, "o" or "i", transport, topic, ...] ...]
  std::vector<Link> all;
  for (int i = 0; i < links.size(); ++i)
    if (links[i].size() > 4 && links[i][1].getType() == XmlRpcValue::TypeString)
      all.push_back({std::string(links[i][1]), std::string(links[i][2]), std::string(links[i][4])});
  return all;
}

/// The nodes at the other end of what a node publishes on a topic; nothing if it does not answer.
std::optional<RosNodes> nodes_reached_by(const std::string& node, const std::string& topic) {
  const auto links = links_of(node);
  if (!links) return {};
  RosNodes nodes;
  for (const Link& link : *links)
    if (link.direction == "o" && link.topic == topic) nodes.insert(link.other);
  return nodes;
}

/// A node that does not answer is not a reason to wait.
bool hears_us(const std::string& node, const std::string& topic) {
  const auto links = links_of(node).value_or(std::vector<Link>{});
  const std::string own = ros::XMLRPCManager::instance()->getServerURI();
  return std::any_of(links.begin(), links.end(), [&](const Link& link) {
    return link.direction == "i" && link.topic == topic && link.other == own;
  });
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

void await_unlinked(const std::string& topic, std::chrono::milliseconds patience) {
  const auto deadline = steady_clock::now() + patience;
  const auto state = master_state();
  if (!state) return;
  for (const std::string& node : without_this(MasterState::of(state->subscribers, topic)))
    while (ros::ok() && steady_clock::now() < deadline && hears_us(node, topic))
      std::this_thread::sleep_for(kUnlinkedLook);
}

}  // namespace limb_ring::bridge
