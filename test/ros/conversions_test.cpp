#include "ros_bridge/conversions.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "ros/small_robot.h"
#include "ros_bridge/command_in.h"
#include "ros_bridge/ros_clock.h"

namespace limb_ring::bridge {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class SplitCommand : public ::testing::Test {
 protected:
  std::string refusal() const {
    try {
      split_command(message, joints);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "not refused";
  }

  JointMap joints{small_robot()};
  sensor_msgs::JointState message;
};

TEST_F(SplitCommand, GivesEachNodeItsJointsInItsOwnOrder) {
  message.name = {"hip_roll", "knee_pitch", "hip_pitch"};
  message.position = {1, 2, 3};
  const auto split = split_command(message, joints);
  ASSERT_EQ(split.parts.size(), 2u);
  EXPECT_EQ(split.parts[0].node, 7);
  EXPECT_EQ(split.parts[0].command.joints.at(0).position, 2);
  EXPECT_EQ(split.parts[1].node, 3);
  EXPECT_EQ(split.parts[1].command.joints.at(0).position, 3);
  EXPECT_EQ(split.parts[1].command.joints.at(1).position, 1);
}

TEST_F(SplitCommand, SendsNothingToNodesThatAreNotCommanded) {
  message.name = {"knee_pitch"};
  message.position = {0.5};
  const auto split = split_command(message, joints);
  ASSERT_EQ(split.parts.size(), 1u);
  EXPECT_EQ(split.parts[0].node, 7);
}

TEST_F(SplitCommand, DoesNotCommandAJointThatIsNotNamed) {
  message.name = {"hip_roll"};
  message.effort = {4};
  const auto split = split_command(message, joints);
  const auto& hip = split.parts.at(0).command.joints;
  EXPECT_FALSE(hip.at(0).effort.has_value());
  EXPECT_EQ(hip.at(1).effort, 4);
  EXPECT_FALSE(hip.at(1).position.has_value());
}

TEST_F(SplitCommand, ObeysTheKnownJointsAndNamesTheUnknown) {
  message.name = {"tail", "knee_pitch"};
  message.position = {1, 2};
  const auto split = split_command(message, joints);
  EXPECT_THAT(split.unknown, ElementsAre("tail"));
  EXPECT_EQ(split.parts.size(), 1u);
}

TEST_F(SplitCommand, RefusesAnArrayOfAnotherLengthNamingBoth) {
  message.name = {"knee_pitch", "hip_roll"};
  message.velocity = {1};
  EXPECT_THAT(refusal(), HasSubstr("'velocity' has 1 entries for 2 names"));
}

TEST_F(SplitCommand, TakesNaNForNotGiven) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  message.name = {"hip_pitch", "hip_roll", "knee_pitch"};
  message.position = {1, nan, -nan};
  message.effort = {nan, 4, nan};
  const auto split = split_command(message, joints);
  ASSERT_EQ(split.parts.size(), 1u) << "of the knee nothing is said";
  const auto& hip = split.parts[0].command.joints;
  EXPECT_EQ(hip.at(0).position, 1);
  EXPECT_FALSE(hip.at(0).effort);
  EXPECT_FALSE(hip.at(1).position);
  EXPECT_EQ(hip.at(1).effort, 4);
  EXPECT_THAT(split.not_given, ElementsAre("knee_pitch"));
}

TEST_F(SplitCommand, RefusesInfiniteValuesNamingTheJoint) {
  message.name = {"knee_pitch", "hip_roll"};
  message.position = {std::numeric_limits<double>::infinity(), 0};
  EXPECT_THAT(refusal(), HasSubstr("'position' of joint 'knee_pitch' is infinity;"));
  message.position = {-std::numeric_limits<double>::infinity(), 0};
  EXPECT_THAT(refusal(), HasSubstr("'position' of joint 'knee_pitch' is minus infinity;"));
}

TEST_F(SplitCommand, RefusesAMessageWithoutNamesAndAJointNamedTwice) {
  message.position = {1};
  EXPECT_THAT(refusal(), HasSubstr("'name' is empty"));
  message.name = {"hip_roll", "hip_roll"};
  message.position = {1, 2};
  EXPECT_THAT(refusal(), HasSubstr("'hip_roll' is named twice"));
}

TEST_F(SplitCommand, RefusesNamesWithoutValues) {
  message.name = {"knee_pitch"};
  EXPECT_THAT(refusal(), HasSubstr("are all empty"));
}

TEST_F(SplitCommand, NamesJointsSoThatTheyCanBePrinted) {
  message.name = {"tail\n[FATAL]", "hip\x1b[31m"};
  message.position = {1, 2};
  EXPECT_THAT(split_command(message, joints).unknown, ElementsAre("tail?[FATAL]", "hip?[31m"));
  message.name = {"tail\n", "tail\n"};
  EXPECT_THAT(refusal(), HasSubstr("'tail?' is named twice"));
  message.position = {std::numeric_limits<double>::infinity(), 0};
  EXPECT_THAT(refusal(), HasSubstr("of joint 'tail?' is inf"));
}

payload::JointCommand command_of(std::int64_t stamp, std::vector<payload::JointCommand::Joint> joints) {
  payload::JointCommand command;
  command.stamp_ns = stamp;
  command.joints = std::move(joints);
  return command;
}

constexpr payload::JointCommand::Joint kNothing{};
constexpr payload::JointCommand::Joint position(double value) { return {value, std::nullopt, std::nullopt}; }

TEST(WaitingCommands, ToOtherJointsOfANodeAreKept) {
  WaitingCommands waiting;
  EXPECT_EQ(waiting.put(command_of(1, {position(1), kNothing})), 0u);
  EXPECT_EQ(waiting.put(command_of(2, {kNothing, position(2)})), 0u);
  const auto first = waiting.take(), second = waiting.take();
  EXPECT_EQ(first->stamp_ns, 1) << "no command is obeyed longer than it was meant to be";
  EXPECT_EQ(first->joints.at(0).position, 1);
  EXPECT_EQ(second->stamp_ns, 2);
  EXPECT_EQ(second->joints.at(1).position, 2);
  EXPECT_FALSE(waiting.take());
}

TEST(WaitingCommands, AreReplacedJointByJoint) {
  WaitingCommands waiting;
  waiting.put(command_of(1, {position(1), position(1)}));
  EXPECT_EQ(waiting.put(command_of(2, {kNothing, position(2)})), 1u);
  EXPECT_EQ(waiting.size(), 2u);
  EXPECT_EQ(waiting.put(command_of(3, {position(3)})), 1u);
  EXPECT_EQ(waiting.size(), 2u) << "nothing is left of the first";
  EXPECT_FALSE(waiting.take()->joints.at(0).position);
  EXPECT_EQ(waiting.take()->joints.at(0).position, 3);
}

TEST(RosTime, KeepsEveryNanosecond) {
  const auto time = to_ros_time(1602256052650440123);
  EXPECT_EQ(time.sec, 1602256052u);
  EXPECT_EQ(time.nsec, 650440123u);
}

TEST(RosTime, EndsAtTheLastTimeOfRos) {
  EXPECT_EQ(to_ros_time(std::numeric_limits<std::int64_t>::max()), ros::TIME_MAX);
  EXPECT_EQ(to_ros_time(-1), ros::Time());
}

TEST(RosTime, OfARingThatFollowsAClockIsThatClocks) {
  RosClock clock;
  clock.set_ring(0);
  clock.set_outer_zero(5000000000);
  EXPECT_EQ(clock.to_ros(7), ros::Time(5, 7));
  EXPECT_EQ(clock.to_ros(std::numeric_limits<std::int64_t>::max()), ros::TIME_MAX) << "a CPU may write any stamp";
  EXPECT_EQ(clock.to_ros(std::numeric_limits<std::int64_t>::min()), ros::Time(5, 0));
  clock.set_outer_zero(-5000000000);
  EXPECT_EQ(clock.to_ros(7), ros::Time());
}

TEST(SensorMessages, CarryAxesStampAndFrame) {
  payload::SensorReading reading;
  reading.linear = {1, 2, 3};
  reading.angular = {4, 5, 6};
  const auto imu = to_imu(reading, ros::Time(5, 7), "hip_imu");
  EXPECT_EQ(imu.header.frame_id, "hip_imu");
  EXPECT_EQ(imu.header.stamp, ros::Time(5, 7));
  EXPECT_EQ(imu.linear_acceleration.y, 2);
  EXPECT_EQ(imu.angular_velocity.z, 6);
  EXPECT_EQ(imu.orientation_covariance[0], -1) << "orientation is not known (REP 145)";
  const auto wrench = to_wrench(reading, ros::Time(5, 7), "hip_force");
  EXPECT_EQ(wrench.wrench.force.x, 1);
  EXPECT_EQ(wrench.wrench.torque.x, 4);
}

TEST(JointStateMessage, HasOneEntryPerFreshJointInEveryArray) {
  const auto message = to_joint_state({{"a", {1, 2, 3}}, {"b", {4, 5, 6}}}, ros::Time(3, 0));
  EXPECT_EQ(message.header.stamp, ros::Time(3, 0));
  EXPECT_THAT(message.name, ElementsAre("a", "b"));
  EXPECT_THAT(message.position, ElementsAre(1, 4));
  EXPECT_THAT(message.velocity, ElementsAre(2, 5));
  EXPECT_THAT(message.effort, ElementsAre(3, 6));
}

}  // namespace
}  // namespace limb_ring::bridge
