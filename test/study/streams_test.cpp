#include "study/response.h"

#include <algorithm>

#include "config/load_ring.h"
#include "study/small_ring.h"

namespace limb_ring::study {
namespace {

using ::testing::ElementsAre;

std::vector<Stream> streams_in(const std::string& yaml) { return streams_of(config::parse_ring(yaml, "ring.yaml")); }

const Stream& named(const std::vector<Stream>& streams, const std::string& name) {
  const auto found = std::find_if(streams.begin(), streams.end(), [&](const Stream& s) { return s.name == name; });
  if (found == streams.end()) throw std::runtime_error("no stream " + name);
  return *found;
}

const char* const kRobot =
    "ring: r\n"
    "firmware: {state_rate: 200}\n"
    "bridge:\n"
    "  rate: 40\n"
    "  topics:\n"
    "    - {input: map, from: body, to: knee, priority: 2, size: 500, rate: 2}\n"
    "    - {input: unplanned, from: body, to: knee}\n"
    "traffic:\n"
    "  - {name: camera, from: knee, to: body, size: 1000, rate: 10, jitter: 2ms, phase: 3ms}\n"
    "  - {name: small, from: knee, to: all, size: 512, rate: 10, priority: 1}\n"
    "  - {name: stop, from: body, to: all, interrupt: 1, rate: 0.5}\n"
    "nodes:\n"
    "  - {id: 7, name: foot, cpu: {command: [f]}, sensors: [{name: sole, kind: force, rate: 50, priority: 2}]}\n"
    "  - {id: 3, name: body, cpu: attached}\n"
    "  - {id: 5, name: knee, cpu: attached, joints: [{name: j}, {name: k}]}\n";

// Places in ring order: foot 0, body 1, knee 2. Commands and states: body is the first attached CPU.
TEST(Streams, JointStatesGoToTheBodyAtTheFirmwaresRate) {
  const Stream state = named(streams_in(kRobot), "state of knee");
  EXPECT_EQ(state.source, 2);
  EXPECT_EQ(state.destination, 1);
  EXPECT_EQ(state.priority, 0);
  EXPECT_EQ(state.bytes, 16u + 2 * 12u);  // joint_state.h: 16 bytes and 12 for each joint
  EXPECT_EQ(state.period, 5ms);
  EXPECT_FALSE(state.phase);
}

TEST(Streams, JointCommandsComeFromTheBodyAllAtOnce) {
  const Stream command = named(streams_in(kRobot), "command to knee");
  EXPECT_EQ(command.source, 1);
  EXPECT_EQ(command.destination, 2);
  EXPECT_EQ(command.priority, 0);
  EXPECT_EQ(command.bytes, 18u + 2 * (1 + 4 + 4));  // joint_command.h: mask, position, velocity
  EXPECT_EQ(command.period, 25ms);
  EXPECT_EQ(command.phase, Duration{0});
}

TEST(Streams, ASensorWithATopicLoadsTheRingTwice) {
  std::string yaml = kRobot;
  yaml.insert(yaml.find("rate: 50"), "topic: gazebo/sole, ");
  const std::vector<Stream> streams = streams_in(yaml);
  const Stream reading = named(streams, "sole"), value = named(streams, "values for sole");
  EXPECT_EQ(value.source, reading.destination);
  EXPECT_EQ(value.destination, reading.source);
  EXPECT_EQ(value.bytes, reading.bytes);
  EXPECT_EQ(value.period, reading.period);
}

TEST(Streams, BroadcastCommandsAreOneMessageOfAsManyPacketsAsItTakes) {
  std::string yaml = kRobot;
  const std::string bridge = "bridge:\n";
  yaml.insert(yaml.find(bridge) + bridge.size(), "  broadcast_commands: true\n");
  const Stream commands = named(streams_in(yaml), "commands");
  EXPECT_EQ(commands.source, 1);
  EXPECT_EQ(commands.destination, wire::kBroadcast);
  EXPECT_EQ(commands.priority, 0);
  EXPECT_EQ(commands.period, 25ms);
  EXPECT_EQ(commands.packets, std::vector<unsigned>{18 + 2 + 2 * (1 + 4 + 4)});  // command_set.h
  std::string nodes;
  for (int id = 10; id < 70; ++id)
    nodes += "  - {id: " + std::to_string(id) + ", name: n" + std::to_string(id) +
             ", cpu: {command: [f]}, joints: [{name: j" + std::to_string(id) + "}]}\n";
  EXPECT_EQ(named(streams_in(yaml + nodes), "commands").packets.size(), 2u);
}

TEST(Streams, SensorsHaveTheirOwnRateAndPriority) {
  const Stream sole = named(streams_in(kRobot), "sole");
  EXPECT_EQ(sole.source, 0);
  EXPECT_EQ(sole.destination, 1);
  EXPECT_EQ(sole.priority, 2);
  EXPECT_EQ(sole.bytes, 40u);  // sensor_reading.h: 16 bytes, 3 and 3 numbers of 4
  EXPECT_EQ(sole.period, 20ms);
}

// fragment.h: 20 bytes of header, at most 492 of the message in each.
TEST(Streams, TopicsTravelAsFragmentsHoweverSmall) {
  EXPECT_THAT(named(streams_in(kRobot), "map").packets, ElementsAre(512, 20 + 500 - 492));
}

TEST(Streams, TopicsWithoutSizeAndRateAreNotPlanned) {
  EXPECT_THROW(named(streams_in(kRobot), "unplanned"), std::runtime_error);
}

TEST(Streams, TrafficTravelsAsFragmentsOnlyIfOnePacketDoesNotHoldIt) {
  const std::vector<Stream> streams = streams_in(kRobot);
  EXPECT_THAT(named(streams, "camera").packets, ElementsAre(512, 512, 20 + 1000 - 2 * 492));
  EXPECT_THAT(named(streams, "small").packets, ElementsAre(512));
}

TEST(Streams, TrafficKeepsItsTargetJitterAndPhase) {
  const std::vector<Stream> streams = streams_in(kRobot);
  EXPECT_EQ(named(streams, "camera").jitter, 2ms);
  EXPECT_EQ(named(streams, "camera").phase, Duration{3ms});
  EXPECT_EQ(named(streams, "camera").destination, 1);
  EXPECT_EQ(named(streams, "small").destination, wire::kBroadcast);
}

TEST(Streams, InterruptsHaveAFactorAndNoPackets) {
  const Stream stop = named(streams_in(kRobot), "stop");
  EXPECT_EQ(stop.interrupt, 1);
  EXPECT_TRUE(stop.packets.empty());
  EXPECT_EQ(stop.period, 2s);
}

TEST(Streams, EveryNodeSendsBeaconsToAll) {
  const Stream beacon = named(streams_in(kRobot), "beacon of foot");
  EXPECT_TRUE(beacon.beacon);
  EXPECT_EQ(beacon.destination, wire::kBroadcast);
  EXPECT_EQ(beacon.bytes, 40u);  // control_message.h, the longest
  EXPECT_EQ(beacon.period, 100ms);
}

// 14 nodes have joints, 4 sensors, 2 cameras, 1 button, 16 beacons; all commands are one: 14 + 1 + 4 + 3 + 16.
TEST(Streams, HumanoidHasThemAll) {
  const auto ring = config::load_ring(std::string(SHIPPED_CONFIG) + "/humanoid16.yaml");
  const std::vector<Stream> streams = streams_of(ring);
  EXPECT_EQ(streams.size(), 38u);
  // 61440 = 124 * 492 + 432
  const Stream camera = named(streams, "left_camera");
  ASSERT_EQ(camera.packets.size(), 125u);
  EXPECT_EQ(camera.packets.back(), 432u + 20u);
}

}  // namespace
}  // namespace limb_ring::study
