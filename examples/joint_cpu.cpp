// joint_cpu.cpp: one joint: obeys joint commands, and sends its state to node 0 a hundred times a second
//   joint_cpu [RING NODE]    as a node's `cpu: {command: [/PATH/joint_cpu]}` without: ringd tells it. What roslaunch
//                            adds behind them plays no part
#include <limb_ring/host_port.h>
#include <limb_ring/payload/joint_command.h>
#include <limb_ring/payload/joint_state.h>
#include <limb_ring/payload/packet_type.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>

using namespace limb_ring;
using namespace std::chrono;

constexpr milliseconds kPeriod{10}, kSilence{200};  // without a command for so long the joint holds still
constexpr double kStep = 2.0 * 0.01;                // rad in a period: 2 rad/s

struct Joint {
  double position = 0, goal = 0;  // rad
  payload::JointState state;
  // When the last command obeyed was given, and the one with the goal; when a stop came. All by now(), which nobody
  // sets.
  std::optional<std::int64_t> obeyed_ns, commanded_ns, stopped_ns;

  void obey(const payload::JointCommand& command, std::int64_t now_ns) {
    const std::int64_t age = now_ns - command.stamp_ns;
    const bool late = std::abs(age) > command.valid_for_us * std::int64_t{1000};
    const bool stale = late || (obeyed_ns && command.stamp_ns <= *obeyed_ns);
    const bool held = stopped_ns && (!command.resume || command.stamp_ns <= *stopped_ns);
    if (stale || held || command.joints.size() > 1) {
      state.mode.command_refused = true;
      ++state.refused;
      return;
    }
    obeyed_ns = command.stamp_ns;
    stopped_ns.reset();
    if (command.joints.empty() || !command.joints[0].position) return;
    goal = *command.joints[0].position;
    commanded_ns = command.stamp_ns;
  }

  void stop(std::int64_t now_ns) {
    stopped_ns = now_ns;
    commanded_ns.reset();  // what resumes says no goal, and the old one is given up
  }

  payload::Encoded next_state(std::int64_t now_ns, std::int64_t stamp_ns) {
    state.stamp_ns = stamp_ns;
    state.mode.stopped = stopped_ns.has_value();
    const bool heard = commanded_ns && now_ns - *commanded_ns < nanoseconds(kSilence).count();
    state.mode.commanded = heard && !state.mode.stopped;
    state.mode.safe = state.mode.hold = !state.mode.commanded;
    const double step = state.mode.commanded ? std::clamp(goal - position, -kStep, kStep) : 0;
    position += step;
    state.joints = {{position, step / 0.01, 0}};
    const auto bytes = payload::encode(state);
    ++state.sequence;
    state.mode.command_refused = false;
    return bytes;
  }
};

int main(int argc, char** argv) try {
  if (argc == 2) {
    std::cerr << "usage: joint_cpu [RING NODE]" << std::endl;
    return 2;
  }
  ConnectOptions options;
  options.role = Role::cpu;
  options.alive_period = milliseconds(100);
  if (argc > 2) options.ring = argv[1], options.node = argv[2];
  HostPort port = HostPort::connect(options);
  Joint joint;
  for (nanoseconds due = port.now(); port.connected();) {  // the ring's clock: it may be a virtual one
    if (const auto message = port.receive(std::max(due - port.now(), nanoseconds(0)))) {
      const auto* packet = std::get_if<Packet>(&*message);
      const auto* interrupt = std::get_if<Interrupt>(&*message);
      if (packet && packet->channel == payload::kJointChannel)
        if (auto command = payload::decode_joint_command(packet->data)) {
          (*command).stamp_ns = (port.now() - port.age_of(command->stamp_ns)).count();
          joint.obey(*command, port.now().count());
        }
      if (interrupt && interrupt->action == Interrupt::Action::stop) joint.stop(port.now().count());
    }
    if (port.now() < due) continue;
    due = std::max(due + kPeriod, port.now());  // what was missed, as in a hang, is not made up for
    const auto state = joint.next_state(port.now().count(), port.stamp().count());
    if (state) port.send(0, *state, 0, payload::kJointChannel);
  }
} catch (const HostPortError& problem) {
  std::cerr << "joint_cpu: " << problem.what() << std::endl;
  return 1;
}
