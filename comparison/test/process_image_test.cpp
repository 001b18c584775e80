// EtherCAT at 1 Gbit/s, a byte in 8 ns, 4 nodes with 512 bytes: an image of 2048 bytes beside 4 event
// bytes does not fit into one frame (1498 - 16 - 12 = 1470), so two frames have 1024 bytes each. A frame:
// 8 + 14 + 2, datagrams 10 + 4 + 2 and 10 + 1024 + 2, FCS 4 = 1080 bytes; with the gap 1092.

#include "comparison/process_image.h"
#include "comparison/test/network_fixture.h"
#include "support/node_literal.h"

namespace limb_ring::study {
namespace {

const Medium kEthercat = gigabit(4);
constexpr Duration kFrame = 8ns * 1080;
constexpr Duration kPitch = 8ns * 1092;
constexpr Duration kFrameCycle = 2 * kPitch;

TEST(EtherCat, ImageIsSharedByAsFewFramesAsHoldIt) {
  const ProcessImage image(kEthercat);
  EXPECT_EQ(image.frames(), 2u);
  EXPECT_EQ(image.length(0), 1080u);
  EXPECT_EQ(image.pitch(1), 1092u);
  EXPECT_EQ(image.slot(0_id), 8u + 14 + 2 + 16 + 10);
  EXPECT_EQ(image.slot(3_id), 50u + 512);
  EXPECT_EQ(image.event(3_id), 8u + 14 + 2 + 10 + 3);
}

// 3 * 512 bytes in two frames of 768: the second slot begins in the first and ends in the second.
TEST(EtherCat, SlotMayLieInTwoFrames) {
  const ProcessImage image(gigabit(3));
  EXPECT_EQ(image.first_frame(1_id), 0u);
  EXPECT_EQ(image.last_frame(1_id), 1u);
}

// 24 + 44 + 4: the least an Ethernet frame holds.
TEST(EtherCat, SmallFrameIsPadded) { EXPECT_EQ(ProcessImage(gigabit(2, 1)).length(0), 72u); }

TEST(EtherCat, DownstreamNodeReadsFromTheSameFrame) {
  EXPECT_EQ(delivery(EtherCat(), kEthercat, data(0ns, 1, 3, 512)), kFrame + 3 * d);
}

TEST(EtherCat, MasterHasTheMessageWhenTheFrameReturns) {
  EXPECT_EQ(delivery(EtherCat(), kEthercat, data(0ns, 3, 0, 512)), kPitch + kFrame + 4 * d);
}

// Home in the middle of the next cycle's first frame, so it goes in that cycle's second.
TEST(EtherCat, UpstreamNodeNeedsASecondFrame) {
  EXPECT_EQ(delivery(EtherCat(), kEthercat, data(0ns, 3, 1, 512)), kFrameCycle + kPitch + kFrame + d);
}

TEST(EtherCat, AllAtOnceEndWithTheLastThatNeedsTwoFrames) {
  EXPECT_EQ(worst(deliveries(EtherCat(), kEthercat, all_to(kEthercat, 2))), kFrameCycle + kPitch + kFrame + d);
}

TEST(EtherCat, MessageCatchesItsSlotUntilItPasses) {
  const Duration passes = 8ns * (50 + 512) + d;  // at node 1
  EXPECT_EQ(delivery(EtherCat(), kEthercat, data(passes, 1, 3, 512)), kFrame + 3 * d);
  EXPECT_EQ(delivery(EtherCat(), kEthercat, data(passes + 1ns, 1, 3, 512)), kFrameCycle + kFrame + 3 * d);
}

TEST(EtherCat, OneMessagePerNodeAndCycleByPriority) {
  const auto at = deliveries(EtherCat(), kEthercat, {data(0ns, 1, 3, 512, 2), data(0ns, 1, 3, 512, 0)});
  EXPECT_EQ(at[1], kFrame + 3 * d);
  EXPECT_EQ(at[0], kFrameCycle + kFrame + 3 * d);
}

TEST(EtherCat, InterruptGoesInTheNextFrameWhateverIsQueued) {
  auto messages = all_to(kEthercat, 1);
  messages.push_back(interrupt(0ns, 3, 1));
  messages.push_back(interrupt(0ns, 1, 2));
  const auto at = deliveries(EtherCat(), kEthercat, messages);
  EXPECT_EQ(at[5], kFrame + 2 * d);
  // Home at 1080 * 8 + 2048 = 10688 ns; the second frame began at 8736, so it is the third.
  EXPECT_EQ(at[4], 2 * kPitch + kFrame + d);
}

// With 5 nodes: 2560 bytes in frames of 1280; a frame 24 + 17 + 12 + 1280 + 4 = 1337 bytes = 10696 ns, with
// the gap 10792. On its way home for 5 d = 2560 ns more, it has let one frame pass: a frame a 21584 ns.
// Switched on behind the first, seen by the second; after five returns it is the second's turn again,
// with the newcomer's slot at 24 + 17 + 10 + (2048 - 1280) = 819 bytes.
TEST(EtherCat, NewNodeIsSeenConfiguredAndTakenIn) {
  EXPECT_EQ(EtherCat().time_to_join(kEthercat), 10792ns + 5 * 21584ns + 819 * 8ns);
}

}  // namespace

// SERCOS II at 1 Gbit/s, a byte in 8 ns, master and 3 slaves with 512 bytes. MST 6 bytes; AT 5 + 4 + 512 =
// 521; MDT 5 + 3 * 4 + 4 * 512 = 2065.

namespace {

const Medium kSercos = gigabit(4);
constexpr Duration kMst = 8ns * 6, kAt = 8ns * 521, kMdt = 8ns * 2065;
constexpr Duration kAtsHome = kMst + 3 * kAt + 4 * d;  // the MDT begins
constexpr Duration kCycle = kAtsHome + kMdt;

TEST(Sercos, SlaveReachesSlaveThroughTheMasterInOneCycle) {
  EXPECT_EQ(delivery(Sercos(), kSercos, data(0ns, 1, 3, 512)), kCycle + 3 * d);
}

TEST(Sercos, MasterHasTheMessageWithTheSlavesTelegram) {
  EXPECT_EQ(delivery(Sercos(), kSercos, data(0ns, 2, 0, 512)), kMst + 2 * kAt + 4 * d);
}

TEST(Sercos, MastersMessageGoesInItsOwnTelegram) {
  EXPECT_EQ(delivery(Sercos(), kSercos, data(kAtsHome, 0, 1, 512)), kCycle + d);
}

TEST(Sercos, AllAtOnceEndWithTheMastersTelegram) {
  EXPECT_THAT(deliveries(Sercos(), kSercos, all_to(kSercos, 2)),
              testing::ElementsAre(kCycle + 2 * d, kCycle + 3 * d, kMst + 2 * kAt + 4 * d, kCycle + d));
}

TEST(Sercos, MessageThatMissesItsTelegramWaitsForTheNextCycle) {
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
