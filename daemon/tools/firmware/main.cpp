#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <memory>

#include <unistd.h>

#include "io/spawn.h"
#include "limb_ring/joint_node.h"
#include "limb_ring/payload/packet_type.h"
#include "tools/common/command_line.h"
#include "tools/firmware/options.h"
#include "tools/firmware/simulated_limb.h"

namespace limb_ring::firmware {
namespace {

volatile std::sig_atomic_t requested = 0;

void on_signal(int) { requested = 1; }

/// Notes SIGTERM and SIGINT.
void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
}

bool stop_requested() { return requested != 0; }

void ignore_signals() {
  sigset_t all;
  sigfillset(&all);
  sigprocmask(SIG_BLOCK, &all, nullptr);
}

/// Does nothing for ever, as a CPU that hangs. Only SIGKILL ends it.
[[noreturn]] void hang() {
  ignore_signals();
  for (;;) pause();
}

/// Goes round and round, as a program with a bug. Only SIGKILL ends it.
[[noreturn]] void loop_endlessly() {
  ignore_signals();
  for (volatile bool forever = true; forever;) {
  }
  std::abort();  // not reached
}

}  // namespace
}  // namespace limb_ring::firmware

namespace {

using namespace limb_ring;
using firmware::FaultCommand;
using firmware::Options;

int fail(const std::exception& error, int code) {
  std::fprintf(stderr, "limb_firmware: %s\n", error.what());
  return code;
}

void say(JointNode& node, const std::string& what) {
  std::fprintf(stderr, "limb_firmware %s: %s\n", node.port().name().c_str(), what.c_str());
}

std::string with_pid(const char* what) { return std::string(what) + " (pid " + std::to_string(::getpid()) + ')'; }

void hang(JointNode& node) {
  say(node, with_pid("hangs on purpose"));
  firmware::hang();
}

bool obey(JointNode& node, const FaultCommand& order) {
  if (order.kind == FaultCommand::Kind::hang) hang(node);
  say(node, "ends on purpose with code " + std::to_string(order.code));
  node.end(order.code);
  return true;
}

/// What a user asks of it beside its work.
void add_faults(JointNode& node, const Options& options) {
  node.on_packet([&node](const Packet& packet) {
    const auto order =
        packet.channel == payload::kUserChannel ? firmware::parse_fault_command(packet.data) : std::nullopt;
    return order && obey(node, *order);
  });
  if (options.hang_after) node.at(node.port().now() + *options.hang_after, [&node] { hang(node); });
  if (options.endless_loop_at && !node.port().in_lockstep())
    throw std::runtime_error("--endless-loop-at is an instant of a virtual ring's clock (ringctl up --clock virtual)");
  if (options.endless_loop_at > node.port().now())
    node.at(*options.endless_loop_at, [&node] {
      say(node, with_pid("is caught in an endless loop on purpose"));
      firmware::loop_endlessly();
    });
}

/// For measurements: a line for each joint command that was obeyed, "CAME STAMP", both in ns of the clock of stamps. A
/// process that takes over after a reset goes on with the file.
void log_commands(JointNode& node, const std::string& path) {
  auto file = std::make_shared<std::ofstream>(path, std::ios::app);
  if (!*file) throw std::runtime_error("--command-log: " + path + " cannot be written");
  node.on_command([&node, file](const payload::JointCommand& command) {
    *file << node.port().stamp().count() << ' ' << command.stamp_ns << std::endl;  // at once: a reset kills
  });
}

void add_sensor(JointNode& node, const NodeSensor& sensor, const firmware::SimulatedLimb& limb) {
  if (sensor.csv.empty()) return node.on_sensor(sensor.name, [&limb, imu = sensor.imu] { return limb.measure(imu); });
  const auto recorded = std::make_shared<firmware::RecordedSensor>(sensor.csv);
  node.on_sensor(sensor.name, [&node, recorded, start = node.port().now()] {
    return recorded->at(std::chrono::duration<double>(node.port().now() - start).count());
  });
}

int run_cpu(const Options& options) {
  JointNode::Options connection;
  connection.ring = options.ring;
  connection.node = options.node;
  connection.at_once = true;
  JointNode node = JointNode::connect(connection);
  firmware::catch_stop_signals();
  node.meanwhile([&node] {
    if (firmware::stop_requested()) node.end(0);
  });
  firmware::SimulatedLimb limb(node.setup());
  node.on_step([&](double dt, const std::vector<JointGoal>& goals) { return limb.step(dt, goals); });
  for (const NodeSensor& sensor : node.setup().sensors)
    if (sensor.topic.empty()) add_sensor(node, sensor, limb);
  add_faults(node, options);
  if (!options.command_log.empty()) log_commands(node, options.command_log);
  const int code = node.run();
  say(node, node.summary());
  return code;
}

}  // namespace

int main(int argc, char** argv) try {
  process::open_standard_descriptors();
  process::outlive_file_limit();
  const auto options = firmware::parse_options(argc, argv);
  if (options.print.empty()) return run_cpu(options);
  std::cout << options.print;
  return cli::code_with_output("limb_firmware", 0);
} catch (const limb_ring::HostPortError& error) {
  return fail(error, 1);
} catch (const std::exception& error) {
  return fail(error, 2);
}
