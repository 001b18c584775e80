#include "ros_bridge/joint_data_out.h"

#include <algorithm>
#include <stdexcept>

#include "limb_ring/payload/packet_type.h"
#include "ros_bridge/conversions.h"
#include "ros_bridge/frames_out.h"

namespace limb_ring::bridge {
namespace {

using Kind = config::SensorConfig::Kind;

/// For so long a desktop may leave a process that wants to run. It is three periods at 100 Hz, so nothing changes
/// there.
constexpr std::chrono::milliseconds kLongestPause{30};

std::chrono::nanoseconds period_of(double rate) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(1 / rate));
}

/// A packet that does not fit is shown in status and diagnostics for so long.
constexpr std::chrono::seconds kShown{3};
constexpr std::size_t kMostSaid = 100;  ///< different ones, in the log

}  // namespace

JointDataOut::JointDataOut(ros::NodeHandle& nodes, const config::RingConfig& ring, double rate, RingPort& port,
                           Counters& counters, const std::string& sample_log)
    : ring_(ring),
      port_(port),
      counters_(counters),
      store_(ring),
      states_(nodes.advertise<sensor_msgs::JointState>("joint_states", 10)) {
  advertise_samples(nodes, ring);
  port_.on_packet(payload::kJointChannel, [this](const Packet& packet) { on_packet(packet); });
  port_.every(
      period_of(rate), [this] { publish_states(); }, ring.bridge.phase);
  if (!sample_log.empty()) log_.open(sample_log);
  if (!sample_log.empty() && !log_)
    throw std::invalid_argument("parameter ~sample_log: " + sample_log + " cannot be written");
}

void JointDataOut::advertise_samples(ros::NodeHandle& nodes, const config::RingConfig& ring) {
  const FrameNames frames;
  for (const auto& node : ring.nodes) {
    Sampled& sampled = sampled_[node.id];
    for (const auto& joint : node.joints) sampled.joints.push_back(joint.name);
    if (!node.joints.empty()) sampled.states = nodes.advertise<sensor_msgs::JointState>("states/" + node.name, 100);
    for (const auto& sensor : node.sensors) {
      const auto topic = "sensors/" + sensor.name;
      sampled.sensors.push_back({sensor.name, frames.of(sensor.name),
                                 sensor.kind == Kind::imu ? nodes.advertise<sensor_msgs::Imu>(topic, 10)
                                                          : nodes.advertise<geometry_msgs::WrenchStamped>(topic, 10),
                                 period_of(sensor.rate), std::nullopt});
    }
  }
}

void JointDataOut::on_packet(const Packet& packet) {
  if (payload::is_type(packet.data, payload::PacketType::joint_state)) return take_state(packet);
  take_reading(packet);
}

void JointDataOut::take_state(const Packet& packet) {
  const auto state = payload::decode_joint_state(packet.data);
  if (!state)
    return refuse(packet.source, "joint_packets_malformed",
                  std::string("a joint state of it cannot be read: ") + payload::to_string(state.error()));
  bool fits = false;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    fits = store_.take(packet.source, *state, port_.now());
  }
  if (!fits)
    return refuse(packet.source, "joint_packets_unfit",
                  "it sends the state of " + std::to_string(state->joints.size()) +
                      " joints, which is not what the ring's file gives it; none of them is taken");
  counters_.add("states_in");
  publish_sample(packet.source, *state);
}

void JointDataOut::publish_sample(std::uint8_t node, const payload::JointState& state) {
  const Sampled& sampled = sampled_.at(node);
  if (sampled.states.getNumSubscribers() == 0) return;
  port_.tell_time();
  std::vector<JointStore::Joint> joints;
  for (std::size_t i = 0; i < sampled.joints.size(); ++i) joints.push_back({sampled.joints[i], state.joints[i]});
  sampled.states.publish(to_joint_state(joints, port_.ros_clock().to_ros(state.stamp_ns)));
}

void JointDataOut::take_reading(const Packet& packet) {
  const auto reading = payload::decode_sensor_reading(packet.data);
  if (!reading)
    return refuse(packet.source, "joint_packets_malformed",
                  std::string("joint data of it cannot be read: ") + payload::to_string(reading.error()));
  const config::NodeConfig* node = ring_.find(packet.source);
  const std::string unfit =
      config::unfit(*reading, node != nullptr ? node->sensors : std::vector<config::SensorConfig>());
  if (!unfit.empty()) return refuse(packet.source, "joint_packets_unfit", "it sends " + unfit);
  Sensor& sensor = sampled_.at(packet.source).sensors[reading->sensor];
  {
    std::lock_guard<std::mutex> lock(mutex_);
    sensor.heard = port_.now();
  }
  counters_.add("readings_in");
  if (sensor.publisher.getNumSubscribers() == 0) return;
  port_.tell_time();
  const ros::Time stamp = port_.ros_clock().to_ros(reading->stamp_ns);
  if (reading->kind == payload::SensorReading::Kind::imu)
    sensor.publisher.publish(to_imu(*reading, stamp, sensor.frame));
  else
    sensor.publisher.publish(to_wrench(*reading, stamp, sensor.frame));
}

void JointDataOut::publish_states() {
  JointStore::Snapshot snapshot;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (!port_.connected()) store_.forget();
    snapshot = store_.snapshot(port_.now(), longest_pause());
    silent_ = snapshot.silent;
  }
  if (snapshot.fresh.empty()) return;
  port_.tell_time();
  publishing_();
  if (log_.is_open()) note(snapshot);
  const auto states = to_joint_state(snapshot.fresh, port_.ros_clock().to_ros(snapshot.oldest_stamp_ns));
  states_.publish(states);
  published_(states.header.stamp);
}

std::chrono::milliseconds JointDataOut::longest_pause() const {
  return port_.in_lockstep() ? std::chrono::milliseconds(0) : kLongestPause;
}

// "NOW NODE:STAMP NODE:STAMP ...", times in ns of the clock of stamps.
void JointDataOut::note(const JointStore::Snapshot& snapshot) {
  log_ << port_.stamp_of(RingPort::Clock::now());
  for (const auto& sample : snapshot.samples) log_ << ' ' << int{sample.node} << ':' << sample.stamp_ns;
  log_ << std::endl;
}

void JointDataOut::refuse(std::uint8_t node, const char* counter, const std::string& why) {
  counters_.lose(counter);
  std::lock_guard<std::mutex> lock(mutex_);
  unfit_[node] = {why, port_.now()};
  if (said_.size() >= kMostSaid || !said_.emplace(node, why).second) return;
  ROS_WARN("node %s: %s", ring_.name_of(node).c_str(), why.c_str());
}

std::string JointDataOut::problem_of(std::uint8_t node) const {
  std::lock_guard<std::mutex> lock(mutex_);
  const auto found = unfit_.find(node);
  return found != unfit_.end() && port_.now() - found->second.at < kShown ? found->second.why : std::string();
}

std::vector<std::string> JointDataOut::silent_sensors() const {
  std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> silent;
  for (const auto& [node, sampled] : sampled_)
    for (const Sensor& sensor : sampled.sensors) {
      const auto patience = std::max<RingPort::Clock::duration>(3 * sensor.period, longest_pause());
      if (!sensor.heard || port_.now() - *sensor.heard > patience) silent.push_back(sensor.name);
    }
  return silent;
}

std::vector<std::string> JointDataOut::silent_joints() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return silent_;
}

JointStore::Received JointDataOut::received(std::uint8_t node) const {
  std::lock_guard<std::mutex> lock(mutex_);
  return store_.received(node);
}

bool JointDataOut::speaks(std::uint8_t node) const {
  std::lock_guard<std::mutex> lock(mutex_);
  return store_.speaks(node, port_.now(), longest_pause());
}

}  // namespace limb_ring::bridge
