#include "limb_ring/payload/joint_state.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "client/hostile_bytes.h"

namespace limb_ring::payload {
namespace {

JointState two_joints() {
  JointState state;
  state.sequence = 0x1234;
  state.stamp_ns = 0x0102030405060708;
  state.mode.commanded = true;
  state.mode.command_refused = true;
  state.refused = 3;
  state.joints = {{1.5, -0.000001, 0.25}, {-2.0, 0, 12.345678}};
  return state;
}

TEST(JointStateFormat, HasTheseBytes) {
  const auto packet = encode(two_joints());
  ASSERT_TRUE(packet);
  EXPECT_THAT(*packet, testing::ElementsAreArray(Bytes{1,    1,                             // type, version
                                                       0x12, 0x34,                          // sequence
                                                       1,    2,    3,    4,    5, 6, 7, 8,  // stamp
                                                       0x21, 2,                 // commanded, command refused; 2 joints
                                                       0,    3,                 // refused
                                                       0x00, 0x16, 0xE3, 0x60,  // 1,500,000
                                                       0xFF, 0xFF, 0xFF, 0xFF,  // -1
                                                       0x00, 0x03, 0xD0, 0x90,  // 250,000
                                                       0xFF, 0xE1, 0x7B, 0x80,  // -2,000,000
                                                       0,    0,    0,    0,     //
                                                       0x00, 0xBC, 0x61, 0x4E}));  // 12,345,678
}

TEST(JointStateFormat, ReadsBackWhatWasWritten) {
  const auto state = decode_joint_state(view(*encode(two_joints())));
  ASSERT_TRUE(state);
  EXPECT_EQ(state->sequence, 0x1234);
  EXPECT_EQ(state->stamp_ns, 0x0102030405060708);
  EXPECT_EQ(state->refused, 3);
  EXPECT_TRUE(state->mode.commanded && state->mode.command_refused);
  EXPECT_FALSE(state->mode.safe || state->mode.hold || state->mode.damp || state->mode.stopped ||
               state->mode.saturated);
  ASSERT_EQ(state->joints.size(), 2U);
  EXPECT_EQ(state->joints[0].velocity, -0.000001);
  EXPECT_EQ(state->joints[1].effort, 12.345678);
}

TEST(JointStateFormat, KeepsEveryModeFlagApart) {
  for (std::uint8_t bit = 0; bit < 7; ++bit) {
    Bytes bytes = *encode(JointState{});
    bytes[12] = static_cast<std::uint8_t>(1 << bit);
    const auto state = decode_joint_state(view(bytes));
    ASSERT_TRUE(state);
    EXPECT_EQ(*encode(*state), bytes);
  }
}

TEST(JointStateFormat, ClampsValuesOutOfRangeAndSaysSo) {
  auto wild = two_joints();
  wild.joints[1] = {1e9, -std::numeric_limits<double>::infinity(), 0};
  const auto state = decode_joint_state(view(*encode(wild)));
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->mode.saturated);
  EXPECT_EQ(state->joints[1].position, 2147.483647);
  EXPECT_EQ(state->joints[1].velocity, -2147.483647);
}

TEST(JointStateFormat, RefusesNotANumberAndNamesTheJoint) {
  auto wild = two_joints();
  wild.joints[1].effort = std::nan("");
  const auto packet = encode(wild);
  ASSERT_FALSE(packet);
  EXPECT_EQ(packet.error().error, EncodeError::not_a_number);
  EXPECT_EQ(to_string(packet.error()), "item 1: is not a number");
}

TEST(JointStateFormat, HoldsAsManyJointsAsOnePacketDoes) {
  JointState state;
  state.joints.resize(kMaxStateJoints);
  ASSERT_TRUE(encode(state));
  EXPECT_EQ(encode(state)->size(), 508U);
  state.joints.emplace_back();
  ASSERT_FALSE(encode(state));
  EXPECT_EQ(encode(state).error().error, EncodeError::too_many_items);
}

TEST(JointStateFormat, RefusesANegativeStampWhenWritingAndReading) {
  JointState state;
  state.stamp_ns = -1;
  ASSERT_FALSE(encode(state));
  Bytes bytes = *encode(JointState{});
  bytes[4] = 0x80;
  ASSERT_FALSE(decode_joint_state(view(bytes)));
  EXPECT_EQ(decode_joint_state(view(bytes)).error(), DecodeError::bad_field);
}

TEST(JointStateFormat, SaysWhatIsWrongWithBytes) {
  const Bytes good = *encode(two_joints());
  const auto error_with = [&](std::size_t at, std::uint8_t value) {
    Bytes bytes = good;
    bytes[at] = value;
    const auto state = decode_joint_state(view(bytes));
    return state ? "none" : std::string(to_string(state.error()));
  };
  EXPECT_EQ(error_with(0, 9), to_string(DecodeError::wrong_type));
  EXPECT_EQ(error_with(1, 2), to_string(DecodeError::wrong_version));
  EXPECT_EQ(error_with(12, 0x80), to_string(DecodeError::bad_field));
  EXPECT_EQ(error_with(13, 42), to_string(DecodeError::bad_count));
  EXPECT_EQ(error_with(13, 3), to_string(DecodeError::truncated));
  EXPECT_EQ(error_with(13, 1), to_string(DecodeError::trailing_bytes));
}

TEST(JointStateFormat, SurvivesHostileBytes) {
  expect_every_truncation_is_refused(*encode(two_joints()), decode_joint_state);
  expect_random_bytes_do_no_harm(1, decode_joint_state);
}

}  // namespace
}  // namespace limb_ring::payload
