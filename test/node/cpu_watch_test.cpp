#include "node/cpu_status.h"

#include <gmock/gmock.h>

#include "config/load_ring.h"
#include "limb_ring/payload/joint_command.h"

namespace limb_ring::runtime {
namespace {

using namespace std::chrono_literals;
using payload::JointState;
using payload::SensorReading;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Of the CPU of knee, which has a joint and an IMU.
class CpuWatchTest : public ::testing::Test {
 protected:
  void SetUp() override { watch.begin(now); }

  static JointState state(bool commanded = false) {
    JointState state;
    state.mode.commanded = commanded;
    state.joints.resize(1);
    return state;
  }
  void sends(const JointState& state) { watch.sent(payload::Decoded<JointState>(state), now); }
  void sends_reading(std::uint8_t sensor, SensorReading::Kind kind = SensorReading::Kind::imu, std::uint8_t to = 0) {
    SensorReading reading;
    reading.kind = kind;
    reading.sensor = sensor;
    watch.sent(payload::Decoded<SensorReading>(reading), to, now);
  }
  void is_given_commands(unsigned count) {
    payload::JointCommand command;
    command.joints.resize(1);
    command.joints[0].position = 1;
    const auto bytes = payload::encode(command);
    for (unsigned i = 0; i < count; ++i) watch.given(*bytes);
  }
  void seconds_pass(int count, const std::function<void()>& each) {
    for (int i = 0; i < count; ++i) {
      now += 1s;
      each();
      watch.look(now);
    }
  }
  std::vector<std::string> texts() const {
    std::vector<std::string> all;
    for (const Warning& warning : watch.warnings()) all.push_back(warning.text);
    return all;
  }

  config::RingConfig ring = config::parse_ring(
      "ring: r\nnodes:\n  - {id: 0, name: body}\n"
      "  - {id: 1, name: knee, cpu: attached, joints: [{name: k, lower: -1, upper: 1, velocity: 1, effort: 1}],\n"
      "     sensors: [{name: foot, kind: imu, rate: 100}]}\n"
      "  - {id: 2, name: hip, cpu: attached, sensors: [{name: a, kind: force}, {name: b, kind: force, topic: /b}]}\n",
      "r.yaml");
  core::Time now{100s};
  std::vector<std::string> log;
  CpuWatch watch{ring, ring.nodes[1], [this](const std::string& text) { log.push_back(text); }};
};

TEST_F(CpuWatchTest, SaysNothingOfACpuThatDoesItsWork) {
  seconds_pass(30, [&] {
    is_given_commands(100);
    sends(state(true));
    sends_reading(0);
  });
  EXPECT_THAT(texts(), IsEmpty());
  EXPECT_EQ(watch.begun(), 0U);
}

TEST_F(CpuWatchTest, TellsOnceOfASensorThatSaysNothingUntilItSpeaksAgain) {
  seconds_pass(10, [&] { sends(state()); });
  EXPECT_THAT(texts(), ElementsAre("its CPU runs and sends no readings of foot"));
  EXPECT_THAT(log, ElementsAre(texts()[0]));
  sends_reading(0);
  seconds_pass(1, [&] { sends(state()); });
  EXPECT_THAT(texts(), IsEmpty());
  EXPECT_EQ(watch.begun(), 1U);
}

TEST_F(CpuWatchTest, LeavesACpuThatSaysNothingAtAllToItsState) {
  seconds_pass(10, [] {});
  EXPECT_THAT(texts(), IsEmpty());
}

TEST_F(CpuWatchTest, TellsOfPacketsThatDoNotFit) {
  JointState two = state();
  two.joints.resize(2);
  for (int i = 0; i < 3; ++i) sends(two);
  sends_reading(0, SensorReading::Kind::force);
  sends_reading(7);
  EXPECT_THAT(texts(), ElementsAre(HasSubstr("the state of 2 joints, and the ring's file gives it 1"),
                                   HasSubstr("a reading of a force sensor as sensor 0"), HasSubstr("as sensor 7")));
}

TEST_F(CpuWatchTest, KnowsThatABridgeHandsASensorWithATopicItsValues) {
  sends_reading(1, SensorReading::Kind::force, 2);
  EXPECT_THAT(texts(), IsEmpty());
  sends_reading(0, SensorReading::Kind::force, 2);  // no topic
  sends_reading(1, SensorReading::Kind::imu, 2);    // of another kind
  EXPECT_THAT(texts(), ElementsAre(HasSubstr("a reading of a force sensor as sensor 0"),
                                   HasSubstr("a reading of an IMU as sensor 1")));
}

TEST_F(CpuWatchTest, TellsWhyNoneOfManyCommandsIsObeyed) {
  const auto speaks = [&](const std::function<void(JointState&)>& change) {
    return [&, change] {
      is_given_commands(CpuWatch::kCommands);
      JointState one = state();
      change(one);
      sends(one);
      sends_reading(0);
    };
  };
  seconds_pass(2, speaks([](JointState&) {}));
  EXPECT_THAT(texts(), ElementsAre(HasSubstr("neither takes nor refuses them")));
  seconds_pass(1, speaks([](JointState& state) { state.mode.commanded = true; }));
  EXPECT_THAT(texts(), IsEmpty());
  std::uint16_t refused = 0;
  sends(state());
  seconds_pass(2, speaks([&](JointState& state) { state.refused = refused += 20; }));
  EXPECT_THAT(texts(), ElementsAre(HasSubstr("it refuses them")));
  seconds_pass(1, speaks([](JointState& state) { state.mode.stopped = true; }));
  EXPECT_THAT(texts(), IsEmpty());
}

TEST_F(CpuWatchTest, KeepsWhatACpuSaysOfItselfUntilTheNextOneComes) {
  for (int i = 0; i < 3; ++i) watch.told("step() sleeps");
  watch.end();
  EXPECT_THAT(texts(), ElementsAre("step() sleeps"));
  EXPECT_EQ(watch.begun(), 1U);
  for (int i = 0; i < 100; ++i) watch.told(std::to_string(i));
  EXPECT_EQ(texts().size(), CpuWatch::kMostWarnings);
  watch.begin(now);
  EXPECT_THAT(texts(), IsEmpty());
}

}  // namespace
}  // namespace limb_ring::runtime
