#include "client/node_cpu.h"

#include <gmock/gmock.h>

#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/packet_type.h"
#include "tools/firmware/firmware_bench.h"

namespace limb_ring::firmware {
namespace {

using namespace bench;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using Outgoing = NodeCpu::Outgoing;

Packet packet(std::uint8_t channel, Bytes data) {
  Packet packet;
  packet.channel = channel;
  packet.data = std::move(data);
  return packet;
}

limb_ring::Result ended(Outcome outcome) {
  limb_ring::Result result;
  result.outcome = outcome;
  return result;
}

/// A CPU whose sends are confirmed at once, stepped from deadline to deadline in virtual time.
class NodeCpuTest : public testing::Test {
 protected:
  NodeCpuTest() {
    cpu.moved_by([this](double dt, const std::vector<JointGoal>& goals) { return servos.step(dt, goals); });
    cpu.measured_by("imu", [this] { return servos.measure(true); });
    cpu.measured_by("force", [this] { return servos.measure(false); });
  }
  std::vector<Outgoing> run_until(nanoseconds end) {
    std::vector<Outgoing> all;
    for (auto due = cpu.due(); due && *due <= at(end).monotonic; due = cpu.due()) {
      cpu.advance(at(*due - at(0ms).monotonic));
      for (auto& outgoing : cpu.take_outgoing()) {
        all.push_back(std::move(outgoing));
        if (confirm) cpu.receive(ended(Outcome::delivered));
      }
    }
    return all;
  }

  NodeCpu cpu{leg(), true, at(0ms)};
  SimulatedLimb servos{leg()};
  bool confirm = true;
};

std::size_t count(const std::vector<Outgoing>& all, payload::PacketType type) {
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [&](const auto& outgoing) { return payload::is_type(view(outgoing.data), type); }));
}

TEST_F(NodeCpuTest, SendsStatesAndReadingsAtTheirRates) {
  const auto all = run_until(1s);
  EXPECT_EQ(count(all, payload::PacketType::joint_state), 100U);
  EXPECT_EQ(count(all, payload::PacketType::imu), 50U);
  EXPECT_EQ(count(all, payload::PacketType::force), 10U);
  EXPECT_THAT(all, Each(Field(&Outgoing::destination, 3)));
  EXPECT_THAT(all, Each(Field(&Outgoing::channel, 2)));
  for (const auto& outgoing : all) {
    const bool imu = payload::is_type(view(outgoing.data), payload::PacketType::imu);
    const bool force = payload::is_type(view(outgoing.data), payload::PacketType::force);
    EXPECT_EQ(outgoing.priority, imu ? 1 : force ? 2 : 0);
  }
}

TEST_F(NodeCpuTest, StampsAndNumbersItsReadings) {
  std::uint16_t next = 0;
  for (const auto& outgoing : run_until(200ms)) {
    const auto reading = payload::decode_sensor_reading(view(outgoing.data));
    if (!reading || reading->kind != payload::SensorReading::Kind::imu) continue;
    EXPECT_EQ(reading->sequence, next++);
    EXPECT_EQ(reading->sensor, 0);
    EXPECT_EQ(reading->stamp_ns, at(20ms * next).wall_ns);
    EXPECT_DOUBLE_EQ(reading->linear[2], 9.80665);
  }
  EXPECT_EQ(next, 10);
}

TEST_F(NodeCpuTest, ObeysACommandAndShowsTheJointsOnTheirWay) {
  cpu.receive_joint_data(packet(2, bytes_of(positions(0ms, {0.5, 0.5}))), at(0ms));
  const auto all = run_until(100ms);
  double before = 0;
  for (const auto& outgoing : all) {
    const auto state = payload::decode_joint_state(view(outgoing.data));
    if (!state) continue;
    EXPECT_TRUE(state->mode.commanded);
    EXPECT_GT(state->joints[0].position, before);
    before = state->joints[0].position;
  }
  EXPECT_GT(before, 0.3);
}

TEST_F(NodeCpuTest, StopsAtAStopInterrupt) {
  Interrupt stop;
  stop.action = Interrupt::Action::stop;
  cpu.receive(stop, at(0ms));
  EXPECT_TRUE(cpu.limb().stopped());
  EXPECT_EQ(cpu.counters().stops, 1U);
}

TEST_F(NodeCpuTest, OnlyCountsANotifyInterrupt) {
  cpu.receive(Interrupt{}, at(0ms));
  EXPECT_FALSE(cpu.limb().stopped());
  EXPECT_EQ(cpu.counters().notifies, 1U);
}

TEST_F(NodeCpuTest, LeavesOutSamplesWhile64HaveNoResult) {
  confirm = false;
  EXPECT_EQ(run_until(1s).size(), 64U);
  EXPECT_EQ(cpu.counters().skipped, 96U);
  cpu.receive(ended(Outcome::lost));
  EXPECT_EQ(run_until(1100ms).size(), 1U);
  EXPECT_EQ(cpu.counters().not_delivered, 1U);
}

TEST_F(NodeCpuTest, WhatIsLeftOutIsMissingInTheSequence) {
  confirm = false;
  run_until(990ms);
  cpu.receive(ended(Outcome::delivered));
  const auto all = run_until(1s);
  ASSERT_EQ(all.size(), 1U);
  const auto state = payload::decode_joint_state(view(all[0].data));
  ASSERT_TRUE(state);
  EXPECT_EQ(state->sequence, 99) << "the hundredth deadline";
}

TEST_F(NodeCpuTest, AProcessThatWasNotScheduledSendsWhatWasDueMeanwhileWithItsTimes) {
  cpu.advance(at(45ms));
  std::vector<std::int64_t> stamps;
  for (const auto& outgoing : cpu.take_outgoing())
    if (const auto state = payload::decode_joint_state(view(outgoing.data))) stamps.push_back(state->stamp_ns);
  EXPECT_THAT(stamps, ElementsAre(at(10ms).wall_ns, at(20ms).wall_ns, at(30ms).wall_ns, at(40ms).wall_ns));
}

TEST_F(NodeCpuTest, ObeysItsOwnPartOfACommandSetAndNoOther) {
  const payload::JointCommand command = positions(0ms, {0.5});
  payload::CommandSet set;
  set.stamp_ns = command.stamp_ns;
  set.valid_for_us = command.valid_for_us;
  set.parts = {{11, {{0.1, {}, {}}}}};
  cpu.receive_joint_data(packet(2, *encode(set)), at(0ms));
  EXPECT_EQ(cpu.limb().count(Verdict::obey), 0U);
  set.parts.push_back({12, command.joints});
  cpu.receive_joint_data(packet(2, *encode(set)), at(0ms));
  EXPECT_EQ(cpu.limb().count(Verdict::obey), 1U);
  cpu.receive_joint_data(packet(2, {5, 1}), at(0ms));
  EXPECT_EQ(cpu.limb().count(Verdict::malformed), 1U);
  EXPECT_EQ(cpu.counters().ignored, 0U);
}

TEST_F(NodeCpuTest, CountsWhatIsNoJointDataAsIgnored) {
  cpu.receive_joint_data(packet(2, {'h', 'a', 'n', 'g'}), at(0ms));
  EXPECT_EQ(cpu.counters().ignored, 1U);
}

TEST_F(NodeCpuTest, NamesTheSensorsForOneThatIsNot) {
  try {
    cpu.measured_by("imus", [] { return SensorValues{}; });
    FAIL() << "a sensor was accepted that is not in the file";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "node left_knee has no sensor 'imus' in the ring's file; it has: imu, force");
  }
  EXPECT_EQ(cpu.unmeasured(), "");
  EXPECT_EQ(NodeCpu(leg(), true, at(0ms)).unmeasured(), "imu");
}

TEST(NodeCpu, SendsEachValueOfATopicOnceAndAtOnceAsAReading) {
  NodeSetup setup = leg();
  setup.joints.clear();
  setup.sensors[1].topic = "gazebo/force";
  NodeCpu cpu(setup, true, at(0ms));
  EXPECT_EQ(cpu.unmeasured(), "imu");
  EXPECT_FALSE(cpu.due()) << "nothing is measured here";
  payload::SensorReading value;
  value.kind = payload::SensorReading::Kind::force;
  value.sensor = 1;
  for (const double z : {9.5, -3.0}) {
    value.linear = {0, 1, z};
    value.angular = {2, 0, 0};
    cpu.receive_joint_data(packet(2, *encode(value)), at(7ms));
    const auto sent = cpu.take_outgoing();
    ASSERT_EQ(sent.size(), 1U);
    EXPECT_EQ(sent[0].destination, 3);
    EXPECT_EQ(sent[0].priority, 2);
    const auto reading = payload::decode_sensor_reading(view(sent[0].data));
    ASSERT_TRUE(reading);
    EXPECT_EQ(reading->sensor, 1);
    EXPECT_EQ(reading->sequence, z < 0);
    EXPECT_EQ(reading->stamp_ns, at(7ms).wall_ns);
    EXPECT_EQ(reading->linear, value.linear);
    EXPECT_EQ(reading->angular, value.angular);
  }
  EXPECT_EQ(cpu.counters().ignored, 0U);

  payload::SensorReading of_imu = value;
  of_imu.sensor = 0;
  payload::SensorReading imu = value;
  imu.kind = payload::SensorReading::Kind::imu;
  for (const auto& unwanted : {of_imu, imu}) cpu.receive_joint_data(packet(2, *encode(unwanted)), at(8ms));
  cpu.measured_by("force", [] { return SensorValues{}; });
  cpu.receive_joint_data(packet(2, *encode(value)), at(8ms));
  EXPECT_TRUE(cpu.take_outgoing().empty()) << "no sensor with a topic, another kind, one that is measured here";
  EXPECT_EQ(cpu.counters().ignored, 3U);
}

TEST_F(NodeCpuTest, SaysWhatItDidInOneLine) {
  run_until(1s);
  cpu.receive_joint_data(packet(2, bytes_of(positions(0ms, {0.5}))), at(1s));
  EXPECT_EQ(cpu.summary(),
            "sent 160, not delivered 0, left out 0; commands: obeyed 0 expired 1; stops 0, "
            "ignored packets 0");
}

TEST(NodeCpu, WithoutJointsAndSensorsHasNothingToSay) {
  NodeCpu cpu(NodeSetup{}, true, at(0ms));
  EXPECT_FALSE(cpu.due());
  cpu.advance(at(10s));
  EXPECT_TRUE(cpu.take_outgoing().empty());
}

}  // namespace
}  // namespace limb_ring::firmware
