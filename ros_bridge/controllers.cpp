#include "ros_bridge/controllers.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace limb_ring::bridge {
namespace {

using Held = RingPort::Held;
using std::chrono::milliseconds;

/// Of real time, from the first joint states on.
constexpr milliseconds kFirstWithin{30'000};

std::string stamp_in_words(ros::Time time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6f s", time.toSec());
  return text;
}

}  // namespace

Controllers::Controllers(const config::RingConfig& ring, RingPort& port, JointDataOut& joints, CommandIn& commands)
    : patience_(ring.virtual_clock.stall), port_(port), joints_(joints), commands_(commands) {
  for (const std::string& topic : ring.bridge.lockstep) {
    controllers_.emplace_back();
    controllers_.back().topic = topic;
  }
  if (controllers_.empty()) return;
  joints_.before_publishing([this] { await_first(); });
  joints_.on_published([this](ros::Time stamp) { await_answers(stamp); });
  commands_.on_heard([this](const CommandIn::Heard& command) { on_command(command); });
}

/// roscpp counts a publisher before that has connected to us, so its first answer could go to nobody. Therefore both
/// ends are asked.
bool Controllers::are_there() {
  const auto arrives = [this](const Controller& controller) {
    return commands_.has_sender(controller.topic) &&
           links_.answers_arrive(joints_.topic(), commands_.resolved(controller.topic));
  };
  return joints_.is_heard() && std::all_of(controllers_.begin(), controllers_.end(), arrives);
}

/// Called once, before the first joint states, since the controllers must hear these already.
void Controllers::await_first() {
  if (!port_.in_lockstep() || awaited_first_) return;
  if (!are_there() && !std::exchange(told_, true))
    ROS_INFO(
        "bridge.lockstep: the ring's time stands still until somebody subscribes to joint_states and somebody "
        "publishes "
        "%s, for %lld s at most",
        topics().c_str(), static_cast<long long>(kFirstWithin.count() / 1000));
  const Held held = port_.hold_time_until([this] { return are_there(); }, kFirstWithin);
  if (held == Held::let_go) return;  // we wait again before the next joint states
  awaited_first_ = true;
  if (held == Held::fulfilled) return;
  if (!joints_.is_heard()) ROS_WARN("bridge.lockstep: nobody subscribes to joint_states");
  for (Controller& controller : controllers_)
    if (!commands_.has_sender(controller.topic)) give_up(controller, kFirstWithin);
}

// `answered` is cleared here because an answer must come after the joint states. Stamps alone do not show that: if a
// node has fallen silent, two joint states in a row may have the same stamp.
void Controllers::await_answers(ros::Time stamp) {
  if (!port_.in_lockstep() || !awaited_first_) return;
  awaited_ = stamp;
  for (Controller& controller : controllers_) {
    controller.answered = false;
    controller.too_old.reset();
  }
  const auto is_done = [this](const Controller& controller) {
    return has_answered(controller) || has_gone(controller);
  };
  const auto all_done = [&] { return std::all_of(controllers_.begin(), controllers_.end(), is_done); };
  if (port_.hold_time_until(all_done, patience_) == Held::let_go) return;
  for (Controller& controller : controllers_)
    if (!has_answered(controller)) give_up(controller, patience_);
}

std::string Controllers::topics() const {
  std::string all;
  for (const Controller& controller : controllers_) all += (all.empty() ? "" : ", ") + controller.topic;
  return all;
}

bool Controllers::has_answered(const Controller& controller) const { return controller.answered || controller.missing; }

bool Controllers::has_gone(const Controller& controller) const { return !commands_.has_sender(controller.topic); }

void Controllers::on_command(const CommandIn::Heard& command) {
  for (Controller& controller : controllers_) {
    if (controller.topic != command.topic) continue;
    controller.name = command.sender;
    if (std::exchange(controller.missing, false))
      ROS_INFO("bridge.lockstep: %s publishes %s again; time waits for it", command.sender.c_str(),
               command.topic.c_str());
    if (command.stamp >= awaited_)
      controller.answered = true;
    else
      controller.too_old = command.stamp;
  }
}

void Controllers::give_up(Controller& controller, milliseconds patience) {
  controller.missing = true;
  const std::string who = controller.name.empty() ? "a controller" : "the controller " + controller.name;
  const std::string within = " within " + std::to_string(patience.count()) + " ms";
  std::string what;
  if (controller.name.empty() && has_gone(controller))
    what = " has not come" + within;
  else if (has_gone(controller))
    what = " has gone, at the joint_states of " + stamp_in_words(awaited_);
  else
    what = " has not answered the joint_states of " + stamp_in_words(awaited_) + within;
  if (controller.too_old)
    what += "; its command has the stamp " + stamp_in_words(*controller.too_old) +
            ", but needs the stamp of the joint_states that it answers, or a later one";
  port_.request(nlohmann::json({{"do", "went_on_without"}, {"whom", who + " on " + controller.topic}}).dump());
  ROS_WARN("bridge.lockstep, %s: %s%s. Time goes on without it, until its next command", controller.topic.c_str(),
           who.c_str(), what.c_str());
}

}  // namespace limb_ring::bridge
