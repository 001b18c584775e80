#include "client/limb.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

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

}  // namespace limb_ring::firmware
