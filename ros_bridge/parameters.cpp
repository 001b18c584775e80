#include "ros_bridge/parameters.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "config/load_ring.h"
#include "config/quantity.h"
#include "config/ring_config.h"

namespace limb_ring::bridge {
namespace {

using CpuKind = config::CpuConfig::Kind;

// The spinner's timer calls alive() ten times in this.
constexpr auto kAlivePeriod = std::chrono::seconds(1);
const std::vector<std::string> kKnown{"clock", "config",  "frames", "node",       "promises",
                                      "rate",  "respawn", "ring",   "sample_log", "tf_prefix"};
constexpr double kMinRate = 0.01, kMaxRate = 1000.0;  // Hz

[[noreturn]] void refuse_type(const std::string& name, const std::string& right, const XmlRpc::XmlRpcValue& given) {
  throw std::invalid_argument("parameter ~" + name + " must be " + right + ", and is '" + as_written(given) + "'");
}

}  // namespace

std::string as_written(XmlRpc::XmlRpcValue value) {
  using XmlRpc::XmlRpcValue;
  std::ostringstream text;
  const char* between = "";
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      text << (static_cast<bool&>(value) ? "true" : "false");
      break;
    case XmlRpcValue::TypeArray:
      for (int i = 0; i < value.size(); ++i, between = ", ") text << between << as_written(value[i]);
      return "[" + text.str() + "]";
    case XmlRpcValue::TypeStruct:
      for (auto entry = value.begin(); entry != value.end(); ++entry, between = ", ")
        text << between << entry->first << ": " << as_written(entry->second);
      return "{" + text.str() + "}";
    default:
      value.write(text);
  }
  return text.str();
}

XmlRpc::XmlRpcValue given_parameter(const ros::NodeHandle& own, const std::string& name) {
  XmlRpc::XmlRpcValue value;
  own.getParam(name, value);
  return value;
}

// roslaunch turns a value such as 12 into a number, whatever it was meant for.
std::string text_parameter(const std::string& name, XmlRpc::XmlRpcValue given) {
  if (!given.valid()) return {};
  if (given.getType() == XmlRpc::XmlRpcValue::TypeInt) return std::to_string(static_cast<int&>(given));
  if (given.getType() != XmlRpc::XmlRpcValue::TypeString) refuse_type(name, "a text", given);
  return static_cast<std::string&>(given);
}

double number_parameter(const std::string& name, XmlRpc::XmlRpcValue given, double usual) {
  if (!given.valid()) return usual;
  if (given.getType() == XmlRpc::XmlRpcValue::TypeInt) return static_cast<int&>(given);
  if (given.getType() != XmlRpc::XmlRpcValue::TypeDouble) refuse_type(name, "a number", given);
  return static_cast<double&>(given);
}

double rate_parameter(XmlRpc::XmlRpcValue given, double configured) {
  const double rate = number_parameter("rate", given, 0.0);
  if (rate == 0.0) return configured;
  if (!(rate >= kMinRate && rate <= kMaxRate))  // nor what is not a number
    throw std::invalid_argument("parameter ~rate is " + as_written(given) +
                                "; it must be 0 (as configured) or 0.01 to 1000 Hz");
  return rate;
}

bool flag_parameter(const std::string& name, XmlRpc::XmlRpcValue given, bool usual) {
  if (!given.valid()) return usual;
  if (given.getType() != XmlRpc::XmlRpcValue::TypeBoolean) refuse_type(name, "true or false", given);
  return static_cast<bool&>(given);
}

namespace {

std::string given_text(const ros::NodeHandle& own, const std::string& name) {
  return text_parameter(name, given_parameter(own, name));
}

bool given_flag(const ros::NodeHandle& own, const std::string& name) {
  return flag_parameter(name, given_parameter(own, name), false);
}

std::string candidates(const config::RingConfig& ring) {
  std::string names;
  for (const auto& node : ring.nodes)
    if (node.cpu.kind == CpuKind::attached) names += (names.empty() ? "" : ", ") + node.name;
  return names.empty() ? "none; give one of them 'cpu: attached'" : names;
}

/// The first word where it is not given.
std::string word_parameter(const ros::NodeHandle& own, const std::string& name, const std::vector<std::string>& words) {
  const std::string told = given_text(own, name), given = told.empty() ? words.front() : told;
  if (std::find(words.begin(), words.end(), given) == words.end())
    throw std::invalid_argument("parameter ~" + name + " is '" + given + "'; it must be " + config::join(words));
  return given;
}

/// As its CPU the bridge drives no joint and reads no sensor: what is given to it would be missed for ever.
const config::NodeConfig& without_joints(const config::NodeConfig& node, const std::string& path) {
  if (node.cpu.kind == CpuKind::attached && (!node.joints.empty() || !node.sensors.empty()))
    throw std::invalid_argument(
        "node '" + node.name + "' of " + path + " has " +
        (node.joints.empty() ? "sensor '" + node.sensors[0].name : "joint '" + node.joints[0].name) +
        "', and ring_bridge is its CPU, which drives no joint and reads no sensor; give it to a node with firmware");
  return node;
}

}  // namespace

const config::NodeConfig& bridge_node(const config::RingConfig& ring, const std::string& named) {
  if (named.empty()) return without_joints(config::body_of(ring), ring.path);
  const config::NodeConfig* chosen = ring.find(named);
  if (!chosen)
    throw std::invalid_argument("parameter ~node: no node '" + named + "' in " + ring.path +
                                "; nodes for a bridge: " + candidates(ring));
  if (chosen->cpu.kind == CpuKind::child)
    throw std::invalid_argument("parameter ~node: node '" + named + "' has a CPU of its own in " + ring.path +
                                "; nodes for a bridge: " + candidates(ring));
  if (chosen->cpu.kind == CpuKind::none)
    throw std::invalid_argument("parameter ~node: node '" + named + "' has 'cpu: none' in " + ring.path +
                                "; nodes for a bridge: " + candidates(ring));
  return without_joints(*chosen, ring.path);
}

std::string config_parameter(const ros::NodeHandle& own) {
  const auto path = given_text(own, "config");
  if (path.empty()) throw std::invalid_argument("parameter ~config is needed: the ring's YAML file");
  return path;
}

std::vector<std::string> unknown_parameters(XmlRpc::XmlRpcValue own) {
  std::vector<std::string> unknown;
  if (own.getType() != XmlRpc::XmlRpcValue::TypeStruct) return unknown;
  for (auto entry = own.begin(); entry != own.end(); ++entry)
    if (std::find(kKnown.begin(), kKnown.end(), entry->first) == kKnown.end()) unknown.push_back(entry->first);
  return unknown;
}

namespace {

// No refusal: one of an earlier run may still be on the parameter server.
void warn_of_unknown(const ros::NodeHandle& own) {
  XmlRpc::XmlRpcValue all;
  if (!ros::param::get(own.getNamespace(), all)) return;
  for (const std::string& name : unknown_parameters(all))
    ROS_WARN("parameter ~%s is unknown and has no effect; there are: %s", config::printable(name).c_str(),
             config::join(kKnown).c_str());
}

}  // namespace

Parameters read_parameters(const ros::NodeHandle& own) {
  warn_of_unknown(own);
  Parameters parameters;
  parameters.ring = config::load_ring(config_parameter(own));
  for (const std::string& warning : parameters.ring.warnings) ROS_WARN("%s", warning.c_str());
  const auto ring = given_text(own, "ring");
  if (!ring.empty()) config::rename_ring(parameters.ring, ring);
  parameters.rate = rate_parameter(given_parameter(own, "rate"), parameters.ring.bridge.rate);
  parameters.promises = given_flag(own, "promises");
  parameters.frames = given_parameter(own, "frames");
  const std::string clock = word_parameter(own, "clock", {"none", "tell", "follow"});
  parameters.tells_time = clock == "tell";
  parameters.follows = clock == "follow";
  parameters.sample_log = given_text(own, "sample_log");
  parameters.daemon.ring = parameters.ring.ring;
  const std::string named = given_text(own, "node");
  const config::NodeConfig& node = bridge_node(parameters.ring, named);
  parameters.daemon.node = node.name;
  parameters.daemon.role = node.cpu.kind == CpuKind::attached ? Role::cpu : Role::tool;
  parameters.daemon.alive_period = kAlivePeriod;
  parameters.daemon.restarted_by_owner = given_flag(own, "respawn");
  parameters.daemon.timeout = std::chrono::milliseconds(0);
  return parameters;
}

}  // namespace limb_ring::bridge
