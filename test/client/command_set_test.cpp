#include "limb_ring/payload/command_set.h"

#include <cmath>

#include <gmock/gmock.h>

#include "client/hostile_bytes.h"
#include "limb_ring/payload/packet_type.h"

namespace limb_ring::payload {
namespace {

CommandSet two_nodes() {
  CommandSet set;
  set.sequence = 7;
  set.stamp_ns = 0x0102030405060708;
  set.valid_for_us = 200000;
  set.parts = {{3, {{1.5, {}, {}}, {}}}, {200, {{{}, -0.5, 0.000002}}}};
  return set;
}

/// So many nodes with one joint each, of which position, velocity and effort are given: 15 bytes a node.
CommandSet nodes(std::uint8_t count) {
  CommandSet set;
  for (std::uint8_t node = 0; node < count; ++node) set.parts.push_back({node, {{1.0, 2.0, 3.0}}});
  return set;
}

TEST(CommandSetFormat, HasTheseBytes) {
  const auto packet = encode(two_nodes());
  ASSERT_TRUE(packet);
  EXPECT_THAT(*packet, testing::ElementsAreArray(Bytes{5,   1,                                // type, version
                                                       0,   7,                                // sequence
                                                       1,   2,    3,    4,    5,    6, 7, 8,  // stamp
                                                       0,   0x03, 0x0D, 0x40,                 // 200,000 us
                                                       0,   2,                                // no flag; 2 nodes
                                                       3,   2,                                // node 3: 2 joints
                                                       1,   0x00, 0x16, 0xE3, 0x60,           // position 1,500,000
                                                       0,                                     // nothing for this one
                                                       200, 1,                                // node 200: 1 joint
                                                       6,   0xFF, 0xF8, 0x5E, 0xE0,           // velocity -500,000
                                                       0,   0,    0,    2}));                 // and effort 2
}

TEST(CommandSetFormat, SaysToEachNodeWhatWasWrittenForIt) {
  const auto set = decode_command_set(view(*encode(two_nodes())));
  ASSERT_TRUE(set);
  const auto command = set->to(200);
  ASSERT_TRUE(command);
  EXPECT_EQ(command->sequence, 7);
  EXPECT_EQ(command->stamp_ns, 0x0102030405060708);
  EXPECT_EQ(command->valid_for_us, 200000U);
  EXPECT_FALSE(command->resume);
  ASSERT_EQ(command->joints.size(), 1U);
  EXPECT_EQ(command->joints[0].velocity, -0.5);
  EXPECT_EQ(set->to(3)->joints.size(), 2U);
  EXPECT_FALSE(set->to(4)) << "it is not in the set";
}

TEST(CommandSetFormat, TheSizeOfAPartIsKnownBeforeItIsWritten) {
  const CommandSet set = two_nodes();
  EXPECT_EQ(encode(set)->size(), kCommandSetHeader + encoded_size(set.parts[0]) + encoded_size(set.parts[1]));
}

TEST(CommandSetFormat, HoldsAsManyNodesAsFitIntoAPacket) {
  EXPECT_TRUE(encode(nodes(32)));  // 18 + 32 * 15 = 498
  const auto more = encode(nodes(33));
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().error, EncodeError::too_many_items);
  EXPECT_EQ(more.error().item, 32U);
}

TEST(CommandSetFormat, RefusesNotANumberAndNamesThePart) {
  CommandSet set = two_nodes();
  set.parts[1].joints[0].effort = std::nan("");
  ASSERT_FALSE(encode(set));
  EXPECT_EQ(encode(set).error().item, 1U);
  EXPECT_EQ(encode(set).error().error, EncodeError::not_a_number);
}

TEST(CommandSetFormat, RefusesANodeThatIsThereTwice) {
  CommandSet set = two_nodes();
  set.parts[1].node = 3;
  ASSERT_FALSE(encode(set));
  EXPECT_EQ(encode(set).error().error, EncodeError::bad_field);
  Bytes bytes = *encode(two_nodes());
  bytes[26] = 3;
  EXPECT_EQ(decode_command_set(view(bytes)).error(), DecodeError::bad_field);
}

TEST(CommandSetFormat, FlagsValuesThatItHadToClamp) {
  CommandSet set = two_nodes();
  set.parts[0].joints[0].position = -5000;
  const auto read = decode_command_set(view(*encode(set)));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->saturated);
  EXPECT_EQ(read->to(3)->joints[0].position, -2147.483647);
}

TEST(CommandSetFormat, ResumesNothing) {
  Bytes bytes = *encode(two_nodes());
  bytes[16] = 1;
  EXPECT_EQ(decode_command_set(view(bytes)).error(), DecodeError::bad_field);
}

TEST(CommandSetFormat, SurvivesHostileBytes) {
  expect_every_truncation_is_refused(*encode(two_nodes()), decode_command_set);
  expect_random_bytes_do_no_harm(5, decode_command_set);
  EXPECT_FALSE(decode_command_set(view(Bytes(kMaxPacket + 1, 5))));
}

}  // namespace
}  // namespace limb_ring::payload
