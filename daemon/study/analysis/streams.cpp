#include "study/analysis/streams.h"

#include <cmath>
#include <numeric>

#include "config/core_settings.h"
#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/fragment.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"
#include "wire/control_message.h"

namespace limb_ring::study {

namespace {

using config::NodeConfig;
using config::RingConfig;

static_assert(config::kLargestMessage == payload::kMaxMessage);

constexpr std::uint8_t kJointPriority = 0;  // of states in firmware, of commands in ring_bridge

Duration period_of(double rate) { return Duration{std::llround(1e12 / rate)}; }

NodeId place_of(const RingConfig& ring, std::uint8_t id) {
  return static_cast<NodeId>(setup::index_of(ring, *ring.find(id)));
}

unsigned state_bytes(const NodeConfig& node) {
  payload::JointState state;
  state.joints.resize(node.joints.size());
  return static_cast<unsigned>(payload::encode(state)->size());
}

unsigned command_bytes(const NodeConfig& node) {
  payload::JointCommand command;
  command.joints.resize(node.joints.size(), {0.0, 0.0, {}});
  return static_cast<unsigned>(payload::encode(command)->size());
}

unsigned reading_bytes() { return static_cast<unsigned>(payload::encode(payload::SensorReading{})->size()); }

std::vector<unsigned> fragments(unsigned bytes) {
  std::vector<unsigned> packets(payload::fragment_count(bytes), payload::kMaxPacket);
  const auto before = static_cast<unsigned>((packets.size() - 1) * payload::kFragmentBytes);
  packets.back() = static_cast<unsigned>(payload::kFragmentHeader) + bytes - before;
  return packets;
}

Stream message(std::string name, NodeId source, NodeId destination, std::uint8_t priority, unsigned bytes,
               double rate) {
  Stream stream;
  stream.name = std::move(name);
  stream.source = source;
  stream.destination = destination;
  stream.priority = priority;
  stream.bytes = bytes;
  stream.packets = {bytes};
  stream.period = period_of(rate);
  return stream;
}

/// As many parts in each packet as fit.
void add_command_sets(const RingConfig& ring, NodeId body, std::vector<Stream>& streams) {
  std::vector<unsigned> packets;
  for (const NodeConfig& node : ring.nodes) {
    if (node.joints.empty()) continue;
    payload::CommandSet::Part part{node.id, {}};
    part.joints.resize(node.joints.size(), {0.0, 0.0, {}});
    const auto bytes = static_cast<unsigned>(encoded_size(part));
    if (packets.empty() || packets.back() + bytes > payload::kMaxPacket) packets.push_back(payload::kCommandSetHeader);
    packets.back() += bytes;
  }
  if (packets.empty()) return;
  const unsigned all = std::accumulate(packets.begin(), packets.end(), 0u);
  streams.push_back(message("commands", body, wire::kBroadcast, kJointPriority, all, ring.bridge.rate));
  streams.back().packets = packets;
}

void add_joints(const RingConfig& ring, std::vector<Stream>& streams) {
  const NodeId body = place_of(ring, config::body_of(ring).id);
  for (const NodeConfig& node : ring.nodes)
    if (!node.joints.empty())
      streams.push_back(message("state of " + node.name, place_of(ring, node.id), body, kJointPriority,
                                state_bytes(node), ring.firmware.state_rate));
  if (ring.bridge.broadcast_commands) return add_command_sets(ring, body, streams);
  for (const NodeConfig& node : ring.nodes) {
    if (node.joints.empty()) continue;
    streams.push_back(message("command to " + node.name, body, place_of(ring, node.id), kJointPriority,
                              command_bytes(node), ring.bridge.rate));
    streams.back().phase = Duration{0};  // one joint_commands message makes them all at once
  }
}

void add_sensors(const RingConfig& ring, std::vector<Stream>& streams) {
  const NodeId body = place_of(ring, config::body_of(ring).id);
  for (const NodeConfig& node : ring.nodes)
    for (const config::SensorConfig& sensor : node.sensors)
      streams.push_back(
          message(sensor.name, place_of(ring, node.id), body, sensor.priority, reading_bytes(), sensor.rate));
}

void add_topics(const RingConfig& ring, std::vector<Stream>& streams) {
  for (const config::TopicConfig& topic : ring.bridge.topics) {
    if (topic.size == 0) continue;
    streams.push_back(message(topic.input, place_of(ring, topic.from), place_of(ring, topic.to), topic.priority,
                              topic.size, topic.rate));
    streams.back().packets = fragments(topic.size);
    streams.back().deadline = core::Duration(topic.deadline);
  }
}

Stream traffic(const RingConfig& ring, const config::TrafficConfig& config) {
  const NodeId to = config.broadcast ? wire::kBroadcast : place_of(ring, config.to);
  Stream stream = message(config.name, place_of(ring, config.from), to, config.priority, config.size, config.rate);
  if (config.size > payload::kMaxPacket) stream.packets = fragments(config.size);
  if (config.interrupt) stream.packets.clear();
  stream.interrupt = config.interrupt;
  stream.jitter = config.jitter;
  stream.phase = config.phase;
  stream.deadline = core::Duration(config.deadline);
  return stream;
}

void add_beacons(const RingConfig& ring, std::vector<Stream>& streams) {
  const double rate = 1000.0 / static_cast<double>(ring.timeouts.beacon.count());
  for (const NodeConfig& node : ring.nodes) {
    streams.push_back(
        message("beacon of " + node.name, place_of(ring, node.id), wire::kBroadcast, 0, wire::kLongBeaconSize, rate));
    streams.back().beacon = true;
  }
}

}  // namespace

std::vector<Stream> streams_of(const RingConfig& ring) {
  std::vector<Stream> streams;
  add_joints(ring, streams);
  add_sensors(ring, streams);
  add_topics(ring, streams);
  for (const config::TrafficConfig& config : ring.traffic) streams.push_back(traffic(ring, config));
  add_beacons(ring, streams);
  return streams;
}

}  // namespace limb_ring::study
