#include "client/node_cpu.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "client/command_filter.h"

namespace limb_ring::firmware {
namespace {

using State = JointGoal::State;

void check(const NodeSetup& setup) {
  if (setup.joints.size() <= payload::kMaxCommandJoints) return;
  throw std::invalid_argument("node '" + setup.name + "' has " + std::to_string(setup.joints.size()) +
                              " joints; one packet carries at most " + std::to_string(payload::kMaxCommandJoints));
}

bool is_empty(const payload::JointCommand::Joint& joint) { return !joint.position && !joint.velocity && !joint.effort; }

std::optional<double> cut(std::optional<double> value, double least, double most) {
  return value ? std::optional(std::clamp(*value, least, most)) : std::nullopt;
}

}  // namespace

Limb::Limb(const NodeSetup& setup, bool at_once, nanoseconds now)
    : node_(setup.name),
      limits_(setup.joints),
      command_timeout_(setup.command_timeout),
      at_once_(at_once),
      goals_(limits_.size()),
      commanded_until_(limits_.size()),
      moved_to_(now),
      filter_(setup.command_timeout) {
  check(setup);
  for (const NodeJoint& joint : limits_) joints_.push_back({joint.initial, 0, 0});
  for (std::size_t i = 0; i < goals_.size(); ++i) go_safe(i);
}

Verdict Limb::command(const payload::Decoded<payload::JointCommand>& command, const Timestamps& now) {
  const Verdict verdict = judge(command, now);
  ++counts_[static_cast<std::size_t>(verdict)];
  if (verdict == Verdict::obey) return verdict;
  ++refused_;
  refused_since_sample_ = true;
  return verdict;
}

Verdict Limb::judge(const payload::Decoded<payload::JointCommand>& command, const Timestamps& now) {
  advance(now.monotonic);
  if (!command) return Verdict::malformed;
  if (command->joints.size() > joints_.size()) return Verdict::unfit;
  const Verdict verdict = filter_.judge(*command, now);
  if (verdict == Verdict::obey) obey(*command, now.monotonic);
  return verdict;
}

void Limb::obey(const payload::JointCommand& command, nanoseconds now) {
  for (std::size_t i = 0; i < command.joints.size(); ++i) {
    const auto& joint = command.joints[i];
    const NodeJoint& limit = limits_[i];
    if (is_empty(joint)) continue;
    goals_[i] = {State::commanded, cut(joint.position, limit.lower, limit.upper),
                 cut(joint.velocity, -limit.velocity, limit.velocity), cut(joint.effort, -limit.effort, limit.effort)};
    commanded_until_[i] = now + command_timeout_;
  }
}

void Limb::stop(const Timestamps& now) {
  advance(now.monotonic);
  filter_.stop(now);
  for (std::size_t i = 0; i < goals_.size(); ++i) go_safe(i);
}

void Limb::go_safe(std::size_t joint) {
  goals_[joint] = {};
  goals_[joint].state = limits_[joint].damps ? State::damp : State::hold;
  if (!limits_[joint].damps) goals_[joint].position = joints_[joint].position;
}

/// Those whose command has run out, at its own time.
void Limb::advance(nanoseconds now) {
  for (;;) {
    nanoseconds next = nanoseconds::max();
    for (std::size_t i = 0; i < goals_.size(); ++i)
      if (goals_[i].state == State::commanded) next = std::min(next, commanded_until_[i]);
    if (next > now) break;
    if (at_once_) move_to(next);
    go_safe_at(next);
  }
  if (at_once_) move_to(now);
}

void Limb::go_safe_at(nanoseconds now) {
  for (std::size_t i = 0; i < goals_.size(); ++i)
    if (goals_[i].state == State::commanded && commanded_until_[i] <= now) go_safe(i);
}

void Limb::move_to(nanoseconds now) {
  if (now <= moved_to_ || joints_.empty()) return;
  const auto joints = step_(std::chrono::duration<double>(now - moved_to_).count(), goals_);
  moved_to_ = now;
  if (joints.size() != joints_.size())
    throw std::logic_error("node " + node_ + ": step() returned " + std::to_string(joints.size()) +
                           " joints, and the ring's file gives it " + std::to_string(joints_.size()) +
                           "; return one for each, in the file's order");
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (std::isnan(joints[i].position) || std::isnan(joints[i].velocity) || std::isnan(joints[i].effort))
      throw std::logic_error("node " + node_ + ": step() returned NaN for joint " + limits_[i].name);
  joints_ = joints;
}

payload::JointState Limb::sample(const Timestamps& now) {
  advance(now.monotonic);
  move_to(now.monotonic);
  payload::JointState state;
  state.sequence = sequence_++;
  state.stamp_ns = now.wall_ns;
  state.refused = refused_;
  state.mode.stopped = filter_.stopped();
  state.mode.command_refused = refused_since_sample_;
  refused_since_sample_ = false;
  add_mode(state.mode);
  state.joints = joints_;
  return state;
}

void Limb::add_mode(payload::JointState::Mode& mode) const {
  for (const JointGoal& goal : goals_) {
    mode.commanded |= goal.state == State::commanded;
    mode.hold |= goal.state == State::hold;
    mode.damp |= goal.state == State::damp;
  }
  mode.safe = mode.hold || mode.damp;
}

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
