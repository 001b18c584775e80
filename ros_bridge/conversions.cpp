#include "ros_bridge/conversions.h"

#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>

#include "config/characters.h"

namespace limb_ring::bridge {
namespace {

using Values = std::vector<double>;

void check_array(const char* name, const Values& values, const std::vector<std::string>& joints) {
  if (!values.empty() && values.size() != joints.size())
    throw std::invalid_argument(std::string("'") + name + "' has " + std::to_string(values.size()) + " entries for " +
                                std::to_string(joints.size()) + " names; it must be empty or have one for each name");
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isinf(values[i]))
      throw std::invalid_argument(std::string("'") + name + "' of joint '" + config::printable(joints[i]) + "' is " +
                                  (values[i] > 0 ? "" : "minus ") +
                                  "infinity; it must be a finite number, or NaN where it is not given");
}

void check(const sensor_msgs::JointState& message) {
  if (message.name.empty()) throw std::invalid_argument("'name' is empty; it must name the joints");
  if (message.position.empty() && message.velocity.empty() && message.effort.empty())
    throw std::invalid_argument(
        "'position', 'velocity' and 'effort' are all empty; one of them must command something");
  check_array("position", message.position, message.name);
  check_array("velocity", message.velocity, message.name);
  check_array("effort", message.effort, message.name);
  std::set<std::string> seen;
  for (const auto& name : message.name)
    if (!seen.insert(name).second)
      throw std::invalid_argument("joint '" + config::printable(name) + "' is named twice");
}

std::optional<double> given(const Values& values, std::size_t i) {
  return values.empty() || std::isnan(values[i]) ? std::nullopt : std::optional(values[i]);
}

payload::JointCommand::Joint joint_at(const sensor_msgs::JointState& message, std::size_t i) {
  return {given(message.position, i), given(message.velocity, i), given(message.effort, i)};
}

geometry_msgs::Vector3 to_vector(const std::array<double, 3>& v) {
  geometry_msgs::Vector3 vector;
  vector.x = v[0];
  vector.y = v[1];
  vector.z = v[2];
  return vector;
}

}  // namespace

CommandSplit split_command(const sensor_msgs::JointState& message, const JointMap& joints) {
  check(message);
  CommandSplit split;
  std::vector<payload::JointCommand> commands(joints.nodes());
  for (std::size_t i = 0; i < message.name.size(); ++i) {
    const auto place = joints.find(message.name[i]);
    if (!place) {
      split.unknown.push_back(config::printable(message.name[i]));
      continue;
    }
    const auto joint = joint_at(message, i);
    if (!joint.position && !joint.velocity && !joint.effort) {
      split.not_given.push_back(message.name[i]);
      continue;
    }
    auto& list = commands[place->node].joints;
    list.resize(joints.joints(place->node));
    list[place->joint] = joint;
  }
  for (std::size_t node = 0; node < commands.size(); ++node)
    if (!commands[node].joints.empty()) split.parts.push_back({joints.id(node), std::move(commands[node])});
  return split;
}

sensor_msgs::JointState to_joint_state(const std::vector<JointStore::Joint>& joints, ros::Time stamp) {
  sensor_msgs::JointState message;
  message.header.stamp = stamp;
  for (const auto& joint : joints) {
    message.name.push_back(joint.name);
    message.position.push_back(joint.state.position);
    message.velocity.push_back(joint.state.velocity);
    message.effort.push_back(joint.state.effort);
  }
  return message;
}

sensor_msgs::Imu to_imu(const payload::SensorReading& reading, ros::Time stamp, const std::string& frame) {
  sensor_msgs::Imu message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.orientation_covariance[0] = -1;
  message.linear_acceleration = to_vector(reading.linear);
  message.angular_velocity = to_vector(reading.angular);
  return message;
}

geometry_msgs::WrenchStamped to_wrench(const payload::SensorReading& reading, ros::Time stamp,
                                       const std::string& frame) {
  geometry_msgs::WrenchStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.wrench.force = to_vector(reading.linear);
  message.wrench.torque = to_vector(reading.angular);
  return message;
}

}  // namespace limb_ring::bridge
