#include "tools/firmware/node_cpu.h"

#include <algorithm>
#include <sstream>

#include "tools/firmware/command_for.h"

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

NodeCpu::NodeCpu(const NodeSetup& setup, const Timestamps& now)
    : node_(setup.node.id), limb_(setup.node, setup.firmware, setup.command_timeout, now), state_to_(setup.state_to) {
  if (!setup.node.joints.empty()) states_.emplace(setup.firmware.state_rate, now.monotonic);
  for (const auto& sensor : setup.node.sensors)
    sensors_.emplace_back(sensor, static_cast<std::uint8_t>(sensors_.size()), now.monotonic);
}

void NodeCpu::receive(const Packet& packet, const Timestamps& now) {
  if (packet.channel == payload::kJointChannel) {
    if (const auto command = command_for(node_, packet.data))
      limb_.command(*command, now);
    else if (!payload::is_type(packet.data, payload::PacketType::command_set))
      ++counters_.ignored;
    return;
  }
  const auto order = packet.channel == payload::kUserChannel ? parse_fault_command(packet.data) : std::nullopt;
  if (!order)
    ++counters_.ignored;
  else if (!fault_command_)
    fault_command_ = order;
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
  for (auto& sensor : sensors_) sample(sensor, now);
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

void NodeCpu::sample(SimulatedSensor& sensor, const Timestamps& now) {
  while (const auto due = sensor.take(now.monotonic)) {
    sensor.leave_out(due->left_out);
    if (may_send())
      send(payload::encode(sensor.sample(limb_, at(due->at, now))), sensor.priority());
    else
      sensor.leave_out(1);
  }
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
  outgoing_.push_back({state_to_, priority, payload::kJointChannel, *bytes});
}

std::vector<NodeCpu::Outgoing> NodeCpu::take_outgoing() {
  std::vector<Outgoing> taken;
  taken.swap(outgoing_);
  return taken;
}

std::optional<nanoseconds> NodeCpu::due() const {
  std::optional<nanoseconds> earliest;
  if (states_) earliest = states_->due();
  for (const auto& sensor : sensors_) earliest = earliest ? std::min(*earliest, sensor.due()) : sensor.due();
  return earliest;
}

std::uint64_t NodeCpu::left_out() const {
  std::uint64_t sum = counters_.skipped + (states_ ? states_->left_out() : 0);
  for (const auto& sensor : sensors_) sum += sensor.left_out();
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
