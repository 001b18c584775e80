#include "limb_ring/payload/joint_command.h"

#include <cmath>

#include <gmock/gmock.h>

#include "client/hostile_bytes.h"

namespace limb_ring::payload {
namespace {

JointCommand three_joints() {
  JointCommand command;
  command.sequence = 7;
  command.stamp_ns = 0x0102030405060708;
  command.valid_for_us = 200000;
  command.resume = true;
  command.joints.resize(3);
  command.joints[0].position = 1.5;
  command.joints[2].velocity = -0.5;
  command.joints[2].effort = 0.000002;
  return command;
}

TEST(JointCommandFormat, HasTheseBytes) {
  const auto packet = encode(three_joints());
  ASSERT_TRUE(packet);
  EXPECT_THAT(*packet, testing::ElementsAreArray(Bytes{2, 1,                                // type, version
                                                       0, 7,                                // sequence
                                                       1, 2,    3,    4,    5,    6, 7, 8,  // stamp
                                                       0, 0x03, 0x0D, 0x40,                 // 200,000 us
                                                       1, 3,                                // resume; 3 joints
                                                       1, 0x00, 0x16, 0xE3, 0x60,           // position 1,500,000
                                                       0,                                   // nothing for this one
                                                       6, 0xFF, 0xF8, 0x5E, 0xE0,           // velocity -500,000
                                                       0, 0,    0,    2}));                 // and effort 2
}

TEST(JointCommandFormat, ReadsBackWhatWasWritten) {
  const auto command = decode_joint_command(view(*encode(three_joints())));
  ASSERT_TRUE(command);
  EXPECT_EQ(command->sequence, 7);
  EXPECT_EQ(command->stamp_ns, 0x0102030405060708);
  EXPECT_EQ(command->valid_for_us, 200000U);
  EXPECT_TRUE(command->resume);
  ASSERT_EQ(command->joints.size(), 3U);
  EXPECT_EQ(command->joints[0].position, 1.5);
  EXPECT_FALSE(command->joints[0].velocity || command->joints[0].effort);
  EXPECT_FALSE(command->joints[1].position || command->joints[1].velocity);
  EXPECT_EQ(command->joints[2].velocity, -0.5);
  EXPECT_EQ(command->joints[2].effort, 0.000002);
}

TEST(JointCommandFormat, HoldsAsManyFullJointsAsOnePacketDoes) {
  JointCommand command;
  command.joints.assign(kMaxCommandJoints, {1.0, 2.0, 3.0});
  ASSERT_TRUE(encode(command));
  EXPECT_EQ(encode(command)->size(), 512U);
  command.joints.emplace_back();
  ASSERT_FALSE(encode(command));
  EXPECT_EQ(encode(command).error().error, EncodeError::too_many_items);
}

TEST(JointCommandFormat, RefusesNotANumberAndNamesTheJoint) {
  auto command = three_joints();
  command.joints[2].velocity = std::nan("");
  ASSERT_FALSE(encode(command));
  EXPECT_EQ(encode(command).error().item, 2U);
  EXPECT_EQ(encode(command).error().error, EncodeError::not_a_number);
}

TEST(JointCommandFormat, FlagsValuesThatItHadToClamp) {
  auto command = three_joints();
  command.joints[0].position = -5000;
  const auto read = decode_joint_command(view(*encode(command)));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->saturated);
  EXPECT_EQ(read->joints[0].position, -2147.483647);
}

TEST(JointCommandFormat, RefusesUnknownFlagsAndMasks) {
  Bytes flags = *encode(three_joints());
  flags[16] = 4;
  EXPECT_EQ(decode_joint_command(view(flags)).error(), DecodeError::bad_field);
  Bytes mask = *encode(three_joints());
  mask[18] = 8;
  EXPECT_EQ(decode_joint_command(view(mask)).error(), DecodeError::bad_field);
}

TEST(JointCommandFormat, SurvivesHostileBytes) {
  expect_every_truncation_is_refused(*encode(three_joints()), decode_joint_command);
  expect_random_bytes_do_no_harm(2, decode_joint_command);
}

}  // namespace
}  // namespace limb_ring::payload
