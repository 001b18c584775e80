#include "client/node_cpu.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "client/command_filter.h"

namespace limb_ring::firmware {

namespace {

/// Results may wait for 20 ms (results_may_wait): 20 samples at 1 kHz, and as many again and more that are under way or
/// wait for the CPU that reads them.
constexpr std::size_t kMostWithoutResult = 64;
constexpr std::uint8_t kStatePriority = 0;

/// The instant `monotonic` on both clocks, by their difference at `now`.
Timestamps at(nanoseconds monotonic, const Timestamps& now) {
  return {monotonic, now.wall_ns - (now.monotonic - monotonic).count()};
}

}  // namespace

NodeCpu::NodeCpu(NodeSetup setup, bool at_once, const Timestamps& now)
    : setup_(std::move(setup)), limb_(setup_, at_once, now.monotonic) {
  if (!setup_.joints.empty()) states_.emplace(setup_.state_rate, now.monotonic);
  for (const NodeSensor& sensor : setup_.sensors) {
    payload::SensorReading reading;
    reading.kind = sensor.imu ? payload::SensorReading::Kind::imu : payload::SensorReading::Kind::force;
    reading.sensor = static_cast<std::uint8_t>(sensors_.size());
    sensors_.push_back(
        {reading, static_cast<std::uint8_t>(sensor.priority), Periodic(sensor.rate, now.monotonic), nullptr});
  }
}

void NodeCpu::measured_by(const std::string& name, std::function<SensorValues()> measure) {
  std::string names;
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    names += (names.empty() ? "" : ", ") + setup_.sensors[i].name;
    if (setup_.sensors[i].name != name) continue;
    sensors_[i].measure = std::move(measure);
    return;
  }
  throw std::invalid_argument("node " + setup_.name + " has no sensor '" + name +
                              "' in the ring's file; it has: " + (names.empty() ? "none" : names));
}

std::string NodeCpu::unmeasured() const {
  for (std::size_t i = 0; i < sensors_.size(); ++i)
    if (!sensors_[i].measure && setup_.sensors[i].topic.empty()) return setup_.sensors[i].name;
  return {};
}

std::optional<payload::JointCommand> NodeCpu::receive_joint_data(const Packet& packet, const Timestamps& now) {
  const auto command = command_for(setup_.id, packet.data);
  if (command && limb_.command(*command, now) == Verdict::obey) return **command;
  if (!command && !payload::is_type(packet.data, payload::PacketType::command_set) && !take_value(packet, now))
    ignore();
  return std::nullopt;
}

/// What a topic says goes out once, when it comes: nothing is held that could grow old.
bool NodeCpu::take_value(const Packet& packet, const Timestamps& now) {
  const auto value = payload::decode_sensor_reading(packet.data);
  if (!value || value->sensor >= sensors_.size()) return false;
  Sensor& sensor = sensors_[value->sensor];
  const bool taken = !setup_.sensors[value->sensor].topic.empty() && !sensor.measure;
  if (!taken || value->kind != sensor.next.kind) return false;
  if (may_send())
    send_reading(sensor, {value->linear, value->angular}, now.wall_ns);
  else
    ++sensor.next.sequence;
  return true;
}

void NodeCpu::receive(const Interrupt& interrupt, const Timestamps& now) {
  if (interrupt.action == Interrupt::Action::notify) {
    ++counters_.notifies;
    return;
  }
  ++counters_.stops;
  limb_.stop(now);
}

void NodeCpu::receive(const limb_ring::Result& result) {
  if (without_result_ > 0) --without_result_;
  // What was cancelled had no end yet when the ring ended: on a virtual ring that instant is not part of the run.
  if (result.outcome != Outcome::delivered && result.outcome != Outcome::cancelled) ++counters_.not_delivered;
}

void NodeCpu::advance(const Timestamps& now) {
  if (states_) sample_states(now);
  for (auto& sensor : sensors_)
    if (sensor.measure) sample(sensor, now);
  limb_.advance(now.monotonic);
}

void NodeCpu::sample_states(const Timestamps& now) {
  while (const auto due = states_->take(now.monotonic)) {
    limb_.leave_out(due->left_out);
    if (may_send())
      send(payload::encode(limb_.sample(at(due->at, now))), kStatePriority);
    else
      limb_.leave_out(1);
  }
}

void NodeCpu::sample(Sensor& sensor, const Timestamps& now) {
  const auto leave_out = [&](std::uint64_t samples) {
    sensor.next.sequence = static_cast<std::uint16_t>(sensor.next.sequence + samples);
  };
  while (const auto due = sensor.periodic.take(now.monotonic)) {
    leave_out(due->left_out);
    if (!may_send()) {
      leave_out(1);
      continue;
    }
    send_reading(sensor, sensor.measure(), at(due->at, now).wall_ns);
  }
}

void NodeCpu::send_reading(Sensor& sensor, const SensorValues& values, std::int64_t stamp_ns) {
  payload::SensorReading reading = sensor.next;
  reading.stamp_ns = stamp_ns;
  reading.linear = values.linear;
  reading.angular = values.angular;
  ++sensor.next.sequence;
  send(payload::encode(reading), sensor.priority);
}

bool NodeCpu::may_send() {
  if (without_result_ < kMostWithoutResult) return true;
  ++counters_.skipped;
  return false;
}

void NodeCpu::send(const payload::Encoded& bytes, std::uint8_t priority) {
  if (!bytes) {
    ++counters_.unreadable;
    return;
  }
  ++without_result_;
  ++counters_.sent;
  outgoing_.push_back({setup_.state_to, priority, payload::kJointChannel, *bytes});
}

std::vector<NodeCpu::Outgoing> NodeCpu::take_outgoing() {
  std::vector<Outgoing> taken;
  taken.swap(outgoing_);
  return taken;
}

std::optional<nanoseconds> NodeCpu::due() const {
  std::optional<nanoseconds> earliest;
  if (states_) earliest = states_->due();
  for (const auto& sensor : sensors_)
    if (sensor.measure) earliest = earliest ? std::min(*earliest, sensor.periodic.due()) : sensor.periodic.due();
  return earliest;
}

std::uint64_t NodeCpu::left_out() const {
  std::uint64_t sum = counters_.skipped + (states_ ? states_->left_out() : 0);
  for (const auto& sensor : sensors_) sum += sensor.periodic.left_out();
  return sum;
}

std::string NodeCpu::summary() const {
  std::ostringstream text;
  text << "sent " << counters_.sent << ", not delivered " << counters_.not_delivered << ", left out " << left_out()
       << "; commands:";
  for (std::size_t i = 0; i < kVerdicts; ++i) {
    const auto verdict = static_cast<Verdict>(i);
    const auto count = limb_.count(verdict);
    if (count > 0 || verdict == Verdict::obey) text << ' ' << to_string(verdict) << ' ' << count;
  }
  text << "; stops " << counters_.stops << ", ignored packets " << counters_.ignored;
  return text.str();
}

}  // namespace limb_ring::firmware
