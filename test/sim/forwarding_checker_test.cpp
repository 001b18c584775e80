// The checker of forwarding, told packet by packet what a node does with the packets of others.
#include "judge/forwarding_checker.h"
#include "support/node_literal.h"

#include <gmock/gmock.h>

namespace limb_ring::sim {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Forwarding : public ::testing::Test {
 protected:
  static constexpr Duration kByte = 8ns;
  static constexpr std::size_t kSize = 524;  // bytes of a full packet

  static PacketHeader header(bool interrupt, NodeId source) {
    PacketHeader header{};
    header.code.interrupt = interrupt;
    header.code_byte = interrupt ? 0x80 : 0;
    header.source = source;
    return header;
  }
  static PacketTrailer trailer(std::uint8_t fbc, NodeId destination) {
    PacketTrailer trailer;
    trailer.fbc = fbc;
    trailer.destination = destination;
    return trailer;
  }

  std::vector<Promise> broken;
  std::string what;
  Complain complain = [this](Promise promise, std::string words) {
    broken.push_back(promise);
    what = words;
  };
  ForwardingChecker checker{4_id, kByte, kByte, complain};
};

TEST_F(Forwarding, APacketThatGoesOnWithTheFbcThatIsDueIsRight) {
  checker.came(header(false, 1_id), 2_id, {0}, kSize, Time(0ns));
  checker.went(header(false, 1_id), trailer(0, 2_id), Time(100ns));
  EXPECT_THAT(broken, IsEmpty());
}

TEST_F(Forwarding, AnotherFbcIsSeen) {
  checker.came(header(false, 1_id), 2_id, {0}, kSize, Time(0ns));
  checker.went(header(false, 1_id), trailer(3, 2_id), Time(100ns));
  EXPECT_THAT(broken, ElementsAre(Promise::true_fbc));
  EXPECT_THAT(what, HasSubstr("goes on with FBC 3 instead of 0 at node 4"));
}

TEST_F(Forwarding, AnyFbcIsRightIfNobodyCanTell) {
  checker.came(header(false, 1_id), 2_id, {ForwardingChecker::kAnyFbc}, kSize, Time(0ns));
  checker.went(header(false, 1_id), trailer(3, 2_id), Time(100ns));
  EXPECT_THAT(broken, IsEmpty());
}

TEST_F(Forwarding, APacketThatNeverCameInIsSeen) {
  checker.went(header(false, 1_id), trailer(0, 2_id), Time(100ns));
  EXPECT_THAT(broken, ElementsAre(Promise::true_fbc));
  EXPECT_THAT(what, HasSubstr("left without having come in"));
}

TEST_F(Forwarding, APacketGoesOnOnce) {
  checker.came(header(false, 1_id), 2_id, {0}, kSize, Time(0ns));
  checker.went(header(false, 1_id), trailer(0, 2_id), Time(100ns));
  checker.went(header(false, 1_id), trailer(0, 2_id), Time(200ns));
  EXPECT_THAT(broken, ElementsAre(Promise::true_fbc));
}

// The first was dropped. The bits of its source's boot number are the same again four starts later.
TEST_F(Forwarding, AnInterruptLikeOneOfLongAgoWaitsFromItsOwnArrivalOn) {
  checker.came(header(true, 1_id), 2_id, {0}, kSize, Time(0ns));
  checker.came(header(true, 1_id), 2_id, {0}, kSize, Time(1ms));
  checker.went(header(true, 1_id), trailer(0, 2_id), Time(1ms));
  EXPECT_THAT(broken, IsEmpty());
}

TEST_F(Forwarding, AnInterruptMayWaitForOddBytesTrailerAndCrc) {
  checker.came(header(true, 1_id), 2_id, {0}, kSize, Time(0ns));
  checker.went(header(true, 1_id), trailer(0, 2_id), Time(11 * kByte));
  EXPECT_THAT(broken, IsEmpty());
}

TEST_F(Forwarding, AnInterruptThatWaitsLongerIsSeen) {
  checker.came(header(true, 1_id), 2_id, {0}, kSize, Time(0ns));
  checker.went(header(true, 1_id), trailer(0, 2_id), Time(11 * kByte + 1ns));
  EXPECT_THAT(broken, ElementsAre(Promise::interrupt_wait));
}

TEST_F(Forwarding, AnInterruptMayWaitForTheOnesBeforeItToo) {
  checker.count_interrupt(Time(5ns));
  checker.came(header(true, 1_id), 2_id, {0}, kSize, Time(0ns));
  checker.went(header(true, 1_id), trailer(0, 2_id), Time((11 + 12) * kByte));
  EXPECT_THAT(broken, IsEmpty());
}

TEST_F(Forwarding, WhatWasClearedNeedNotGoOnAndMayNot) {
  checker.came(header(false, 1_id), 2_id, {0}, kSize, Time(0ns));
  checker.clear();
  checker.went(header(false, 1_id), trailer(0, 2_id), Time(100ns));
  EXPECT_THAT(broken, ElementsAre(Promise::true_fbc));
}

}  // namespace
}  // namespace limb_ring::sim
