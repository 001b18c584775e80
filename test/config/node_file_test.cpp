#include <csignal>

#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using ::testing::ElementsAre;
using Action = PinConfig::Action;

/// Node 0 of a ring, with these entries.
NodeConfig node_of(const std::string& more) {
  const RingConfig ring = parse_ring(node_with(more), "ring.yaml");
  return *ring.find(std::uint8_t{0});
}

TEST(NodeFile, WithOnlyAnIdHasTheDefaults) {
  const NodeConfig node = node_of("");
  EXPECT_EQ(node.name, "node0");
  EXPECT_EQ(node.cpu.kind, CpuConfig::Kind::none);
  EXPECT_TRUE(node.joints.empty());
  EXPECT_TRUE(node.sensors.empty());
  EXPECT_EQ(node.pins[0].action, Action::reset);
  EXPECT_EQ(node.pins[1].action, Action::stop);
  EXPECT_EQ(node.pins[2].action, Action::sync);
  for (int factor = 3; factor < 8; ++factor) EXPECT_EQ(node.pins[factor].action, Action::none);
  for (const auto& input : node.inputs) EXPECT_FALSE(input);
}

TEST(NodeFile, CpuIsNoneAttachedOrACommand) {
  EXPECT_EQ(node_of("    cpu: none\n").cpu.kind, CpuConfig::Kind::none);
  EXPECT_EQ(node_of("    cpu: attached\n").cpu.kind, CpuConfig::Kind::attached);
  const CpuConfig child = node_of("    cpu: {command: [limb_firmware, --x]}\n").cpu;
  EXPECT_EQ(child.kind, CpuConfig::Kind::child);
  EXPECT_THAT(child.command, ElementsAre("limb_firmware", "--x"));
  EXPECT_TRUE(child.restart_on_exit);
  EXPECT_FALSE(node_of("    cpu: {command: [a], restart_on_exit: false}\n").cpu.restart_on_exit);
}

TEST(NodeFile, CpuDeclaresAnAlivePeriodOrIsNotWatched) {
  EXPECT_EQ(node_of("    cpu: {command: [a]}\n").cpu.alive_period, milliseconds{0});
  const CpuConfig slow = node_of("    cpu: {command: [a], turnaround: 40us, jitter: 5us}\n").cpu;
  EXPECT_EQ(slow.turnaround, std::chrono::microseconds{40});
  EXPECT_EQ(slow.jitter, std::chrono::microseconds{5});
  EXPECT_EQ(node_of("    cpu: {command: [a], alive_period: 200ms}\n").cpu.alive_period, milliseconds{200});
  const CpuConfig attached = node_of("    cpu: {attached: true, alive_period: 1s}\n").cpu;
  EXPECT_EQ(attached.kind, CpuConfig::Kind::attached);
  EXPECT_EQ(attached.alive_period, milliseconds{1000});
  EXPECT_EQ(node_of("    cpu: {attached: false, command: [a]}\n").cpu.kind, CpuConfig::Kind::child);
}

TEST(NodeFile, JointsHaveLimitsAndASafeState) {
  const NodeConfig node = node_of(
      "    cpu: attached\n"
      "    joints:\n"
      "      - {name: l_knee, lower: -2.1, upper: -0.1, velocity: 5, effort: 80, initial: -0.5, "
      "safe: damp}\n"
      "      - {name: plain}\n");
  ASSERT_EQ(node.joints.size(), 2u);
  EXPECT_EQ(node.joints[0].name, "l_knee");
  EXPECT_EQ(node.joints[0].lower, -2.1);
  EXPECT_EQ(node.joints[0].upper, -0.1);
  EXPECT_EQ(node.joints[0].velocity, 5.0);
  EXPECT_EQ(node.joints[0].effort, 80.0);
  EXPECT_EQ(node.joints[0].initial, -0.5);
  EXPECT_EQ(node.joints[0].safe, JointConfig::Safe::damp);
  EXPECT_EQ(node.joints[1].lower, JointConfig{}.lower);
  EXPECT_EQ(node.joints[1].safe, JointConfig::Safe::hold);
}

TEST(NodeFile, SensorsHaveKindRateAndPriority) {
  const NodeConfig node = node_of(
      "    cpu: attached\n"
      "    sensors: [{name: foot, kind: force, rate: 50, priority: 2}, {name: imu}]\n");
  ASSERT_EQ(node.sensors.size(), 2u);
  EXPECT_EQ(node.sensors[0].kind, SensorConfig::Kind::force);
  EXPECT_EQ(node.sensors[0].rate, 50.0);
  EXPECT_EQ(node.sensors[0].priority, 2);
  EXPECT_EQ(node.sensors[1].kind, SensorConfig::Kind::imu);
}

TEST(NodeFile, PinsDriveWhatTheySay) {
  const NodeConfig node = node_of(
      "    pins: {0: none, 1: stop, 2: sync, 3: notify, 4: {signal: USR1},\n"
      "           5: {exec: [logger, hit]}, 6: reset}\n");
  EXPECT_EQ(node.pins[0].action, Action::none);
  EXPECT_EQ(node.pins[1].action, Action::stop);
  EXPECT_EQ(node.pins[2].action, Action::sync);
  EXPECT_EQ(node.pins[3].action, Action::notify);
  EXPECT_EQ(node.pins[4].action, Action::signal);
  EXPECT_EQ(node.pins[4].signal, SIGUSR1);
  EXPECT_EQ(node.pins[5].action, Action::exec);
  EXPECT_THAT(node.pins[5].command, ElementsAre("logger", "hit"));
  EXPECT_EQ(node.pins[6].action, Action::reset);
  EXPECT_EQ(node.pins[7].action, Action::none);
}

TEST(NodeFile, InputsLeadToANodeOrToAll) {
  const NodeConfig node = node_of("    inputs: {0: {to: all, factor: 3}, 7: {to: knee, factor: 0}}\n");
  ASSERT_TRUE(node.inputs[0]);
  EXPECT_TRUE(node.inputs[0]->broadcast);
  EXPECT_EQ(node.inputs[0]->factor, 3);
  ASSERT_TRUE(node.inputs[7]);
  EXPECT_FALSE(node.inputs[7]->broadcast);
  EXPECT_EQ(node.inputs[7]->node, 1);
  EXPECT_EQ(node.inputs[7]->factor, 0);
  EXPECT_FALSE(node.inputs[1]);
}

TEST(NodeFile, ARingKnowsWhichFactorsReset) {
  const RingConfig ring = parse_ring(node_with("    pins: {5: reset}\n"), "ring.yaml");
  EXPECT_TRUE(ring_has_reset_on(ring, 0));
  EXPECT_TRUE(ring_has_reset_on(ring, 5));
  EXPECT_FALSE(ring_has_reset_on(ring, 1));
  EXPECT_FALSE(ring_has_reset_on(ring, 8));
}

}  // namespace
}  // namespace limb_ring::config
