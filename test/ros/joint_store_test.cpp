#include "ros_bridge/conversions.h"

#include <gmock/gmock.h>

#include "ros/small_robot.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::uint8_t kKnee = 7, kHip = 3;

class Joints : public ::testing::Test {
 protected:
  bool take(std::uint8_t node, std::uint16_t sequence, std::int64_t stamp, std::vector<double> positions) {
    payload::JointState state;
    state.sequence = sequence;
    state.stamp_ns = stamp;
    for (const double position : positions) state.joints.push_back({position, 0, 0});
    return store.take(node, state, now);
  }
  std::vector<std::string> fresh() const {
    std::vector<std::string> names;
    for (const auto& joint : store.snapshot(now).fresh) names.push_back(joint.name);
    return names;
  }

  JointStore store{small_robot()};  // 100 Hz: silent after 30 ms
  JointStore::Clock::time_point now{1h};
};

TEST_F(Joints, AreNotSilentWhileTheMachineMayHavePausedTheirNode) {
  take(kHip, 0, 100, {1, 2});
  now += 31ms;
  EXPECT_THAT(fresh(), IsEmpty());
  EXPECT_FALSE(store.speaks(kHip, now));
  EXPECT_THAT(store.snapshot(now, 40ms).fresh, SizeIs(2));
  EXPECT_TRUE(store.speaks(kHip, now, 40ms));
  now += 10ms;
  EXPECT_THAT(store.snapshot(now, 40ms).fresh, IsEmpty());
  EXPECT_FALSE(store.speaks(kHip, now, 40ms));
}

TEST_F(Joints, AreSilentUntilTheirNodeSpeaks) {
  EXPECT_THAT(fresh(), IsEmpty());
  EXPECT_THAT(store.snapshot(now).silent, ElementsAre("knee_pitch", "hip_pitch", "hip_roll"));
  take(kHip, 0, 100, {1, 2});
  EXPECT_THAT(fresh(), ElementsAre("hip_pitch", "hip_roll"));
  EXPECT_THAT(store.snapshot(now).silent, ElementsAre("knee_pitch"));
}

TEST_F(Joints, WithoutAMotorFollowTheirLeader) {
  auto ring = small_robot();
  ring.followers = {{"toe", "knee_pitch", -2, 0.5}};
  store = JointStore(ring);
  EXPECT_THAT(store.snapshot(now).silent, ElementsAre("knee_pitch", "hip_pitch", "hip_roll", "toe"));
  take(kKnee, 0, 100, {3});
  EXPECT_THAT(fresh(), ElementsAre("knee_pitch", "toe"));
  EXPECT_EQ(store.snapshot(now).fresh[1].state.position, -5.5);
  const JointMap map(ring);
  EXPECT_FALSE(map.find("toe"));
  EXPECT_EQ(map.leader_of("toe"), "knee_pitch");
  EXPECT_EQ(map.leader_of("hip_roll"), "");
}

TEST_F(Joints, CarryTheStampOfTheOldestSample) {
  take(kHip, 0, 200, {1, 2});
  take(kKnee, 0, 100, {3});
  EXPECT_EQ(store.snapshot(now).oldest_stamp_ns, 100);
  take(kKnee, 1, 300, {3});
  EXPECT_EQ(store.snapshot(now).oldest_stamp_ns, 200);
}

TEST_F(Joints, AreLeftOutAfterThreePeriodsAndTheirStampWithThem) {
  take(kKnee, 0, 100, {3});
  now += 20ms;
  take(kHip, 0, 200, {1, 2});
  now += 10ms;
  EXPECT_THAT(store.snapshot(now).silent, IsEmpty());
  now += 1ns;
  EXPECT_THAT(store.snapshot(now).silent, ElementsAre("knee_pitch"));
  EXPECT_EQ(store.snapshot(now).oldest_stamp_ns, 200);
}

TEST_F(Joints, AreSilentAtOnceWhenTheConnectionIsLost) {
  take(kKnee, 0, 100, {3});
  store.forget();
  EXPECT_THAT(fresh(), IsEmpty());
}

TEST_F(Joints, OfUnknownNodesOrAnotherNumberAreRefused) {
  EXPECT_FALSE(take(99, 0, 100, {1}));
  EXPECT_FALSE(take(0, 0, 100, {})) << "a body without joints sends no states";
  EXPECT_FALSE(take(kHip, 0, 100, {1}));
  EXPECT_EQ(store.received(kHip).states, 0u);
}

TEST_F(Joints, CountWhatIsMissingInTheSequence) {
  take(kKnee, 65534, 100, {1});
  take(kKnee, 65535, 101, {1});
  take(kKnee, 0, 102, {1});
  EXPECT_EQ(store.received(kKnee).missing, 0u) << "the number wraps";
  take(kKnee, 4, 103, {1});
  EXPECT_EQ(store.received(kKnee).missing, 3u);
  EXPECT_EQ(store.received(kKnee).states, 4u);
}

TEST_F(Joints, CountTheCommandsThatTheirCpuDidNotObey) {
  const auto refused = [this](std::uint16_t sequence, std::uint16_t since_its_start) {
    payload::JointState state;
    state.sequence = sequence;
    state.refused = since_its_start;
    state.joints.resize(1);
    store.take(kKnee, state, now);
    return store.received(kKnee).refused;
  };
  EXPECT_EQ(refused(2000, 65530), 0u) << "of before";
  EXPECT_EQ(refused(2001, 65535), 5u);
  EXPECT_EQ(refused(2002, 1), 7u) << "the count wraps";
  EXPECT_EQ(refused(2003, 40000), 40006u);
  EXPECT_EQ(refused(0, 3), 40009u) << "a restarted CPU counts from 0";
}

TEST_F(Joints, OfARestartedCpuAreNotCountedAsMissing) {
  take(kKnee, 500, 100, {1});
  take(kKnee, 0, 101, {1});
  EXPECT_EQ(store.received(kKnee).missing, 0u);
}

}  // namespace
}  // namespace limb_ring::bridge
