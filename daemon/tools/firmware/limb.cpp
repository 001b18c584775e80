#include "tools/firmware/limb.h"

#include <stdexcept>
#include <string>

namespace limb_ring::firmware {
namespace {

void check(const config::NodeConfig& node) {
  if (node.joints.size() <= payload::kMaxCommandJoints) return;
  throw std::invalid_argument("node '" + node.name + "' has " + std::to_string(node.joints.size()) +
                              " joints; one packet carries at most " + std::to_string(payload::kMaxCommandJoints));
}

bool is_empty(const payload::JointCommand::Joint& joint) { return !joint.position && !joint.velocity && !joint.effort; }

}  // namespace

Limb::Limb(const config::NodeConfig& node, const config::Firmware& firmware, nanoseconds command_timeout,
           const Timestamps& now)
    : filter_(command_timeout) {
  check(node);
  for (const auto& joint : node.joints) joints_.emplace_back(joint, firmware, command_timeout, now.monotonic);
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
    if (!is_empty(joint)) joints_[i].command({joint.position, joint.velocity, joint.effort}, now);
  }
}

void Limb::stop(const Timestamps& now) {
  advance(now.monotonic);
  filter_.stop(now);
  for (auto& joint : joints_) joint.go_safe();
}

void Limb::advance(nanoseconds now) {
  for (auto& joint : joints_) joint.advance(now);
}

payload::JointState Limb::sample(const Timestamps& now) {
  advance(now.monotonic);
  payload::JointState state;
  state.sequence = sequence_++;
  state.stamp_ns = now.wall_ns;
  state.refused = refused_;
  state.mode.stopped = filter_.stopped();
  state.mode.command_refused = refused_since_sample_;
  refused_since_sample_ = false;
  add_mode(state.mode);
  for (const auto& joint : joints_) {
    const Servo& servo = joint.servo();
    state.joints.push_back({servo.position(), servo.velocity(), servo.effort()});
  }
  return state;
}

void Limb::add_mode(payload::JointState::Mode& mode) const {
  for (const auto& joint : joints_) {
    mode.commanded |= joint.state() == Joint::State::commanded;
    mode.hold |= joint.state() == Joint::State::hold;
    mode.damp |= joint.state() == Joint::State::damp;
  }
  mode.safe = mode.hold || mode.damp;
}

}  // namespace limb_ring::firmware
