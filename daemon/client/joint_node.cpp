#include "limb_ring/joint_node.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>
#include <utility>

#include "client/command_filter.h"
#include "client/node_cpu.h"
#include "limb_ring/payload/packet_type.h"

namespace limb_ring {
namespace {

using firmware::Timestamps;
using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr int kMessagesPerTurn = 64;  // then the joints are due again, however many wait
constexpr milliseconds kLongestWait{100}, kAnswer{2000};
/// What comes in while a sample is due so soon is taken with it, as by a control loop, which reads its commands once in
/// a period. At 1 kHz a wake-up of its own for each command costs as much as all the rest.
constexpr milliseconds kControlPeriod{1};
/// So many periods of a node's firmware tell whether it keeps up.
constexpr int kPeriodsJudged = 50;
constexpr std::size_t kLongestWarning = 1000;  // bytes

Timestamps read_clocks(const HostPort& port) {
  const nanoseconds now = port.now();
  return {now, port.stamp_of(now).count()};
}

NodeJoint joint_of(const json& row) {
  return {row.at("name"),     row.at("slides"), row.at("lower"),   row.at("upper"),
          row.at("velocity"), row.at("effort"), row.at("initial"), row.at("damps")};
}

NodeSetup setup_of(const std::string& answer) try {
  const json row = json::parse(answer);
  NodeSetup setup;
  setup.id = row.at("id");
  setup.name = row.at("name");
  for (const json& joint : row.at("joints")) setup.joints.push_back(joint_of(joint));
  for (const json& sensor : row.at("sensors"))
    setup.sensors.push_back({sensor.at("name"), sensor.at("imu"), sensor.at("rate"), sensor.at("priority"),
                             sensor.at("csv"), sensor.at("topic")});
  setup.state_rate = row.at("state_rate");
  setup.bandwidth = row.at("bandwidth");
  setup.damping = row.at("damping");
  setup.command_timeout = milliseconds(row.at("command_timeout_ms").get<std::int64_t>());
  setup.state_to = row.at("state_to");
  const milliseconds alive_period(row.at("alive_period_ms").get<std::int64_t>());
  if (alive_period.count() != 0) setup.alive_period = alive_period;
  return setup;
} catch (const json::exception& problem) {
  throw HostPortError(std::string("the daemon's setup of this node cannot be read: ") + problem.what());
}

/// Asked by a tool first: a CPU says how often it will speak when it connects.
NodeSetup ask_for_setup(ConnectOptions connection) {
  connection.role = Role::tool;
  connection.asks_only = true;
  HostPort tool = HostPort::connect(connection);
  return setup_of(tool.ask(R"({"do": "setup"})", kAnswer));
}

}  // namespace

struct JointNode::Impl {
  Impl(HostPort opened, NodeSetup setup, const Options& options)
      : port(std::move(opened)),
        speak_every(nanoseconds(setup.alive_period) / 4),
        cpu(std::move(setup), options.at_once, read_clocks(port)) {}

  int run() {
    check_use();
    while (!exit_code) {
      cpu.advance(read_clocks(port));  // so that a command does not act on the time before it came
      take_messages();
      if (exit_code) break;
      say_whether_stopped();
      cpu.advance(read_clocks(port));
      send();
      call_what_is_due();
      if (meanwhile) meanwhile();
      if (!exit_code) wait();
    }
    return *std::exchange(exit_code, std::nullopt);
  }

  void check_use() {
    if (!has_step && !cpu.setup().joints.empty())
      throw std::logic_error("node " + port.name() +
                             " has joints, and nothing moves them: call on_step() before run()");
    if (const std::string sensor = cpu.unmeasured(); !sensor.empty())
      warn("nothing measures sensor " + sensor + " of the ring's file, so nobody hears of it: on_sensor(\"" + sensor +
           "\", ...)");
  }

  void say(const std::string& what) const {
    std::fprintf(stderr, "limb_ring: node %s: %s\n", port.name().c_str(), what.c_str());
  }

  /// Also to the daemon, which logs it, counts it and shows it in its status.
  void warn(const std::string& what) {
    say(what);
    tell_daemon(what);
  }
  void tell_daemon(const std::string& what) {
    const json request{{"do", "warn"}, {"text", what.substr(0, kLongestWarning)}};
    if (port.connected()) port.request(request.dump(-1, ' ', false, json::error_handler_t::replace));
  }

  /// What ends the firmware is known where its robot is looked at, not only where it printed.
  template <class Call>
  auto told(const Call& call) {
    try {
      return call();
    } catch (const std::exception& problem) {
      tell_daemon(problem.what());
      throw;
    }
  }

  /// What has ended the wait, and what has come with it. If nothing has, nothing is asked for: that is a system
  /// call.
  void take_messages() {
    for (int i = 0; i < kMessagesPerTurn && message && !exit_code; ++i) {
      std::visit([this](const auto& content) { take(content); }, *message);
      message = port.receive(nanoseconds(0));
    }
  }

  void take(const Packet& packet) {
    if (packet.channel != payload::kJointChannel) {
      if (!on_packet || !on_packet(packet)) cpu.ignore();
      return;
    }
    const auto command = cpu.receive_joint_data(packet, read_clocks(port));
    if (command && on_command) on_command(*command);
  }
  void take(const Interrupt& interrupt) {
    cpu.receive(interrupt, read_clocks(port));
    if (interrupt.action == Interrupt::Action::notify && on_notify) on_notify(interrupt);
  }
  void take(const Result& result) { cpu.receive(result); }
  void take(const Disconnected& end) {
    say("disconnected: " + end.reason);
    exit_code = 1;
  }
  void take(const Reply&) {}
  void take(const Observed&) {}
  void take(const ObservedLost&) {}
  void take(const CapturedPacket&) {}
  void take(const CaptureCounts&) {}

  /// The network controller shows it in its status and beacons.
  void say_whether_stopped() {
    if (cpu.limb().stopped() == said_stopped) return;
    said_stopped = cpu.limb().stopped();
    port.tell_stopped(said_stopped);
  }

  void send() {
    const auto outgoing = cpu.take_outgoing();
    for (const auto& packet : outgoing) port.send(packet.destination, packet.data, packet.priority, packet.channel);
    const auto now = port.now();
    if (outgoing.empty() && now >= speak_at) port.alive();
    if (!outgoing.empty() || now >= speak_at) speak_at = now + speak_every;
  }

  void call_what_is_due() {
    for (std::size_t i = 0; i < calls.size();) {
      if (calls[i].first > port.now()) {
        ++i;
        continue;
      }
      const auto call = std::move(calls[i].second);
      calls.erase(calls.begin() + static_cast<std::ptrdiff_t>(i));
      call();
    }
  }

  void wait() {
    if (message) return;
    const nanoseconds now = port.now();
    nanoseconds until = std::min(speak_at, now + kLongestWait);
    if (const auto due = cpu.due()) until = std::min(until, *due);
    for (const auto& [time, call] : calls) until = std::min(until, time);
    const nanoseconds left = std::max(until - now, nanoseconds(0));
    const bool is_short = left <= kControlPeriod && !port.in_lockstep();
    if (is_short) std::this_thread::sleep_for(left);
    message = port.receive(is_short ? nanoseconds(0) : left);
  }

  /// A step that takes longer than its period makes a live node late, and holds up a whole virtual ring.
  std::vector<Joint> timed(const Step& step, double dt, const std::vector<JointGoal>& goals) {
    const auto begun = steady_clock::now();
    std::vector<Joint> joints = step(dt, goals);
    if (slow_said) return joints;
    in_steps += steady_clock::now() - begun;
    of_steps += dt;
    if (++steps < kPeriodsJudged) return joints;
    const double real = std::chrono::duration<double>(in_steps).count();
    if (real > of_steps) {
      slow_said = true;
      warn("step() takes longer than what it steps over, " + std::to_string(real / of_steps) + " s for each second: " +
           (port.in_lockstep() ? "the virtual ring waits for it; do not sleep in it, time is dt"
                               : "states and sensor readings are left out"));
    }
    steps = 0;
    in_steps = {};
    of_steps = 0;
    return joints;
  }

  HostPort port;
  nanoseconds speak_every;
  firmware::NodeCpu cpu;
  std::function<void()> meanwhile;
  bool has_step = false;
  std::function<bool(const Packet&)> on_packet;
  std::function<void(const Interrupt&)> on_notify;
  std::function<void(const payload::JointCommand&)> on_command;
  std::vector<std::pair<nanoseconds, std::function<void()>>> calls;  ///< by at()
  std::optional<int> exit_code;
  nanoseconds speak_at{0};
  std::optional<Message> message;  ///< that has ended the wait
  bool said_stopped = false;
  bool slow_said = false;
  int steps = 0;
  steady_clock::duration in_steps{};
  double of_steps = 0;
};

JointNode JointNode::connect(const Options& options) {
  ConnectOptions connection;
  connection.ring = options.ring;
  connection.node = options.node;
  connection.runtime = options.runtime;
  connection.meanwhile = options.meanwhile;
  NodeSetup setup = ask_for_setup(connection);
  connection.role = Role::cpu;
  connection.alive_period = setup.alive_period;
  connection.results_may_wait = true;  // they are counted, no more
  HostPort port = HostPort::connect(connection);
  return JointNode(std::make_unique<Impl>(std::move(port), std::move(setup), options));
}

JointNode JointNode::connect(int argc, const char* const* argv) {
  const std::string program = argc > 0 ? argv[0] : "PROGRAM";
  if (argc == 2) throw std::invalid_argument("usage: " + program.substr(program.rfind('/') + 1) + " [RING NODE]");
  Options options;
  if (argc > 2) options.ring = argv[1], options.node = argv[2];
  return connect(options);
}

JointNode::JointNode(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
JointNode::JointNode(JointNode&&) noexcept = default;
JointNode& JointNode::operator=(JointNode&&) noexcept = default;
JointNode::~JointNode() = default;

const NodeSetup& JointNode::setup() const { return impl_->cpu.setup(); }
HostPort& JointNode::port() { return impl_->port; }
const std::vector<JointNode::Joint>& JointNode::joints() const { return impl_->cpu.limb().joints(); }

void JointNode::on_step(Step step) {
  impl_->has_step = true;
  impl_->cpu.moved_by([impl = impl_.get(), step = std::move(step)](double dt, const std::vector<JointGoal>& goals) {
    return impl->timed(step, dt, goals);
  });
}

void JointNode::on_sensor(const std::string& name, std::function<SensorValues()> measure) {
  impl_->told([&] { impl_->cpu.measured_by(name, std::move(measure)); });
}

void JointNode::on_packet(std::function<bool(const Packet&)> take) { impl_->on_packet = std::move(take); }
void JointNode::on_notify(std::function<void(const Interrupt&)> take) { impl_->on_notify = std::move(take); }
void JointNode::on_command(std::function<void(const payload::JointCommand&)> take) {
  impl_->on_command = std::move(take);
}

void JointNode::meanwhile(std::function<void()> call) { impl_->meanwhile = std::move(call); }

void JointNode::at(nanoseconds time, std::function<void()> call) { impl_->calls.emplace_back(time, std::move(call)); }

int JointNode::run() {
  return impl_->told([this] { return impl_->run(); });
}
void JointNode::end(int code) { impl_->exit_code = code; }
std::string JointNode::summary() const { return impl_->cpu.summary(); }

}  // namespace limb_ring
