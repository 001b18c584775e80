// SERCOS II at 1 Gbit/s, a byte in 8 ns, master and 3 slaves with 512 bytes. MST 6 bytes; AT 5 + 4 + 512 =
// 521; MDT 5 + 3 * 4 + 4 * 512 = 2065.
#include "comparison/process_image.h"
#include "comparison/test/network_fixture.h"

namespace limb_ring::study {
namespace {

const Medium kSercos = gigabit(4);
constexpr Duration kMst = 8ns * 6, kAt = 8ns * 521, kMdt = 8ns * 2065;
constexpr Duration kAtsHome = kMst + 3 * kAt + 4 * d;  // the MDT begins
constexpr Duration kCycle = kAtsHome + kMdt;

TEST(Sercos, SlaveReachesSlaveThroughTheMasterInOneCycle) {
  EXPECT_EQ(delivery(Sercos(), kSercos, data(0ns, 1, 3, 512)), kCycle + 3 * d);
}

TEST(Sercos, MasterHasItWithTheSlavesOwnTelegram) {
  EXPECT_EQ(delivery(Sercos(), kSercos, data(0ns, 2, 0, 512)), kMst + 2 * kAt + 4 * d);
}

TEST(Sercos, MastersOwnGoesInItsTelegram) {
  EXPECT_EQ(delivery(Sercos(), kSercos, data(kAtsHome, 0, 1, 512)), kCycle + d);
}

TEST(Sercos, AllAtOnceEndWithTheMastersTelegram) {
  EXPECT_THAT(deliveries(Sercos(), kSercos, all_to(kSercos, 2)),
              testing::ElementsAre(kCycle + 2 * d, kCycle + 3 * d, kMst + 2 * kAt + 4 * d, kCycle + d));
}

TEST(Sercos, WhatMissesItsTelegramWaitsForTheNextCycle) {
  const Duration begins = kMst + kAt + 2 * d;  // at slave 2
  EXPECT_EQ(delivery(Sercos(), kSercos, data(begins, 2, 3, 512)), kCycle + 3 * d);
  EXPECT_EQ(delivery(Sercos(), kSercos, data(begins + 1ns, 2, 3, 512)), 2 * kCycle + 3 * d);
}

TEST(Sercos, OneMessagePerNodeAndCycleByPriority) {
  const auto at = deliveries(Sercos(), kSercos, {data(0ns, 1, 3, 512, 1), data(0ns, 1, 3, 512, 0)});
  EXPECT_EQ(at[1], kCycle + 3 * d);
  EXPECT_EQ(at[0], 2 * kCycle + 3 * d);
}

TEST(Sercos, InterruptIsABitBesideTheData) {
  EXPECT_EQ(deliveries(Sercos(), kSercos, {data(0ns, 1, 3, 512), interrupt(0ns, 1, 3)})[1], kCycle + 3 * d);
}

// Ring of 5, so 4 slaves and 5 d round: ten MSTs; 4 times, and 4 * 8 * 2 times, a cycle for one slave (MST, two
// telegrams of 9 bytes); two whole cycles with an MDT of 5 + 4 * 4 + 5 * 512 bytes; the newcomer's AT.
TEST(Sercos, NewNodeBringsTheRingUpThroughItsPhases) {
  const Duration lap = 5 * d;
  const Duration one_slave = kMst + 2 * 8ns * 9 + lap;
  const Duration whole = kMst + 4 * kAt + 8ns * 2581 + lap;
  EXPECT_EQ(Sercos().time_to_join(kSercos),
            10 * (kMst + lap) + 4 * one_slave + 64 * one_slave + 2 * whole + kMst + 3 * kAt + 4 * d);
}

}  // namespace
}  // namespace limb_ring::study
