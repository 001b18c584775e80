// How many packets a CPU has taken, told by its credit.
#include "node/program_stage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace limb_ring::program_stage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Taken : testing::Test {
  std::vector<std::size_t> after_credit(unsigned count) {
    std::vector<std::size_t> sends;
    packets.credited(count, [&](std::size_t send) { sends.push_back(send); });
    return sends;
  }
  TakenPackets packets;
};

TEST_F(Taken, TheFirstCreditIsOfNoPacket) {
  EXPECT_THAT(after_credit(8), IsEmpty());
  packets.given(3);
  EXPECT_THAT(after_credit(1), ElementsAre(3));
}

TEST_F(Taken, PacketsAreTakenInTheOrderInWhichTheyWereGiven) {
  after_credit(8);
  for (const std::size_t send : {4u, 5u, 6u}) packets.given(send);
  EXPECT_THAT(after_credit(2), ElementsAre(4, 5));
  EXPECT_THAT(after_credit(1), ElementsAre(6));
}

TEST_F(Taken, APacketOfNoSendIsNotCounted) {
  after_credit(8);
  packets.given(std::nullopt);
  packets.given(7);
  EXPECT_THAT(after_credit(1), IsEmpty());
  EXPECT_THAT(after_credit(1), ElementsAre(7));
}

TEST_F(Taken, MoreCreditThanThereWerePacketsIsNoPacket) {
  after_credit(2);
  packets.given(1);
  EXPECT_THAT(after_credit(5), ElementsAre(1));
  packets.given(2);
  EXPECT_THAT(after_credit(1), ElementsAre(2));
}

TEST_F(Taken, WhatAnEarlierCpuHadNotTakenIsGone) {
  after_credit(8);
  packets.given(1);
  packets.clear();
  EXPECT_THAT(after_credit(8), IsEmpty());
  packets.given(2);
  EXPECT_THAT(after_credit(1), ElementsAre(2));
}

}  // namespace
}  // namespace limb_ring::program_stage
