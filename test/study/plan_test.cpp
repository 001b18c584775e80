#include "study/plan.h"

#include "sim/planned_ring.h"
#include "study/small_ring.h"

namespace limb_ring::study {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Its messages would take years on the line: 63000 laps each, 100000 times a second.
TEST(Plan, ARingAskedForMoreThanAnyTimeHoldsHasNoBounds) {
  config::RingConfig ring = small_ring(255);
  for (config::NodeConfig& node : ring.nodes) node.link.rate = 1000;
  std::vector<unsigned> packets(62976, 512);
  packets.push_back(1);
  std::vector<Stream> streams;
  for (NodeId n{0}; n < 35; ++n) streams.push_back(stream_from(n, static_cast<NodeId>(n + 1), packets, 10us));
  const Plan made = plan(ring, streams);
  for (const StreamPlan& stream : made.streams) {
    EXPECT_EQ(stream.confirmed, std::nullopt);
    EXPECT_EQ(stream.why, "no bound");
    EXPECT_GT(stream.load, 1e9);
  }
  EXPECT_FALSE(made.carried());
}

// protocol.md section 7.2, request of the CPU to tail back: (N + 1) T + N d = 79.456 us.
TEST(Plan, SixteenNodesOfThePaper) {
  config::RingConfig ring = small_ring(16);
  std::vector<Stream> streams;
  for (NodeId n{0}; n < 16; ++n) {
    ring.nodes[n].link.delay = 512ns;
    streams.push_back(stream_from(n, static_cast<NodeId>((n + 1) % 16), {512}, 1ms));
  }
  const Plan made = plan(ring, streams);
  for (const StreamPlan& stream : made.streams) {
    EXPECT_EQ(stream.confirmed, ns(79456));
    EXPECT_EQ(stream.delivered, ns(4192 + 4192 + 512));
    EXPECT_DOUBLE_EQ(stream.load, 0.075264);
  }
  for (const double line : made.lines) EXPECT_DOUBLE_EQ(line, 16 * 0.004192);
  EXPECT_TRUE(made.carried());
}

// a's packet takes 0.8 us, b's 1.6 us; d = 1 us. Both laps 0.8 + 1.6 + 2 = 4.4 us.
//   a: one of b ahead, 1.6: confirmed 6.0, at b 1.6 + 0.8 + 1 = 3.4
//   b: one of a ahead, 0.8: confirmed 5.2, at a 0.8 + 1.6 + 1 = 3.4
TEST(Plan, TwoNodesWaitForOneOfTheOthersPackets) {
  const Plan made = plan(small_ring(2), {stream_from(0, 1, {kHundred}, 1ms), stream_from(1, 0, {188}, 1ms)});
  EXPECT_EQ(made.streams[0].confirmed, ns(6000));
  EXPECT_EQ(made.streams[0].delivered, ns(3400));
  EXPECT_EQ(made.streams[1].confirmed, ns(5200));
  EXPECT_EQ(made.streams[1].delivered, ns(3400));
  EXPECT_EQ(made.streams[0].why, "own + 1 ahead (1.600 us), laps of up to 4.400 us");
}

/// Three nodes whose packets all take 0.8 us: every lap is 3 * 0.8 + 3 * 1 = 5.4 us, one ahead is 0.8 us.
std::vector<Stream> with_others(std::vector<Stream> of_a) {
  of_a.push_back(stream_from(1, 0, {kHundred}, 1s));
  of_a.push_back(stream_from(2, 0, {kHundred}, 1s));
  return of_a;
}

// high: one lower is under way, 5.4; then its own lap: 10.8. At c, two hops: 5.4 + 0.8 + 2 + b's 0.8 = 9.0.
// low:  one ahead, high, 0.8 + 5.4 = 6.2; then its own lap: 11.6. At c: 6.2 + 3.6 = 9.8.
TEST(Plan, ThreeNodesAndTwoPriorities) {
  const Plan made =
      plan(small_ring(3), with_others({stream_from(0, 2, {kHundred}, 1ms, 1), stream_from(0, 2, {kHundred}, 1ms, 3)}));
  EXPECT_EQ(made.streams[0].confirmed, ns(10800));
  EXPECT_EQ(made.streams[0].delivered, ns(9000));
  EXPECT_EQ(made.streams[1].confirmed, ns(11600));
  EXPECT_EQ(made.streams[1].delivered, ns(9800));
  EXPECT_EQ(made.streams[0].why, "own + 1 of lower priority, laps of up to 5.400 us");
  EXPECT_EQ(made.streams[1].why, "own + 1 of higher or same priority + 1 ahead (0.800 us), laps of up to 5.400 us");
}

// To all: c is the last one to have it, as above.
TEST(Plan, ABroadcastIsDeliveredWhenTheLastNodeHasIt) {
  const Plan made = plan(small_ring(3), with_others({stream_from(0, wire::kBroadcast, {kHundred}, 1ms)}));
  EXPECT_EQ(made.streams[0].delivered, ns(800 + 3600));
  EXPECT_EQ(made.streams[0].confirmed, ns(800 + 5400));
}

TEST(Plan, APacketToItsOwnNodeIsDeliveredWhenItIsHome) {
  const Plan made = plan(small_ring(3), with_others({stream_from(0, 0, {kHundred}, 1ms)}));
  EXPECT_EQ(made.streams[0].delivered, made.streams[0].confirmed);
}

// One ahead and three laps: 0.8 + 3 * 5.4 = 17.0. Another message at its priority waits for all three:
// 0.8 + 4 * 5.4 = 22.4, and a higher one for one of them: 5.4 + 5.4.
TEST(Plan, AMessageOfThreePacketsIsABurst) {
  const std::vector<unsigned> burst(3, kHundred);
  const Plan made =
      plan(small_ring(3), with_others({stream_from(0, 1, burst, 1ms, 3), stream_from(0, 1, {kHundred}, 1ms, 3),
                                       stream_from(0, 1, {kHundred}, 1ms, 0)}));
  const Plan alone = plan(small_ring(3), with_others({stream_from(0, 1, burst, 1ms)}));
  EXPECT_EQ(alone.streams[0].confirmed, ns(17000));
  EXPECT_EQ(alone.streams[0].why, "own 3 + 1 ahead (0.800 us), laps of up to 5.400 us");
  EXPECT_DOUBLE_EQ(alone.streams[0].load, 3 * 0.0054);
  EXPECT_EQ(made.streams[1].confirmed, ns(22400 + 5400));  // the one of priority 0 too
  EXPECT_EQ(made.streams[2].confirmed, ns(10800));
}

// The NC's beacon goes before priority 0 and waits for one packet at most.
TEST(Plan, BeaconsGoBeforePriorityZero) {
  std::vector<Stream> streams =
      with_others({stream_from(0, 1, {kHundred}, 1ms), stream_from(0, wire::kBroadcast, {kHundred}, 1ms)});
  streams[1].beacon = true;
  const Plan made = plan(small_ring(3), streams);
  EXPECT_EQ(made.streams[0].confirmed, ns(800 + 2 * 5400));
  EXPECT_EQ(made.streams[1].confirmed, ns(2 * 5400));
}

// N = 2, d = 1 us: 2 * (1 + 0.096 + 0.064) = 2.32 us, and one INTP ahead: 2.416. The second of the node waits for
// the first: 4.736. Each DATP's lap of 2.8 us is 0.096 longer for each INTP that may come: 2.992.
TEST(Plan, InterruptsWaitForInterruptsOnly) {
  const Plan made = plan(small_ring(2), {interrupts_from(0, 1, 1, 1s), stream_from(0, 1, {kHundred}, 1ms)});
  EXPECT_EQ(made.streams[0].confirmed, ns(2416));
  EXPECT_EQ(made.streams[0].delivered, ns(96 + 1000 + 96 + 64));
  EXPECT_EQ(made.streams[1].confirmed, ns(2800 + 96 + 96));  // the INTP in its lap, and ahead of it
  const Plan two = plan(small_ring(2), {interrupts_from(0, 1, 1, 1s), interrupts_from(0, 1, 2, 1s)});
  EXPECT_EQ(two.streams[0].confirmed, ns(2416 + 2320));
  EXPECT_EQ(two.streams[1].confirmed, ns(2416 + 2320));
}

// A lap of 5.4 us every 5 us: 108 % of the time. Priority 0 alone, 5.4 in 100 us, keeps its bound.
TEST(Plan, AnOverloadedNodeIsNamedWithWhatIsMissing) {
  const Plan made = plan(small_ring(3),
                         with_others({stream_from(0, 1, {kHundred}, 100us, 0), stream_from(0, 1, {kHundred}, 5us, 3)}));
  EXPECT_FALSE(made.carried());
  EXPECT_EQ(made.streams[0].confirmed, ns(10800));
  EXPECT_FALSE(made.streams[1].confirmed);
  EXPECT_EQ(made.streams[1].why, "no bound");
  EXPECT_THAT(made.limits, ElementsAre("node a would need 113.4 % of the time for its data packets, one at a time in "
                                       "their worst laps: 13.4 % too much"));
  EXPECT_THAT(verdict(small_ring(3), made), HasSubstr("cannot be relied on to carry this:\n  node a would"));
}

// Three packets of 0.8 us every 2 us are 120 % of each line; and 5.4 us of each node's 2.
TEST(Plan, AnOverloadedLineIsNamedFirst) {
  const Plan made = plan(small_ring(3), {stream_from(0, 1, {kHundred}, 2us), stream_from(1, 2, {kHundred}, 2us),
                                         stream_from(2, 0, {kHundred}, 2us)});
  ASSERT_EQ(made.limits.size(), 4u);
  EXPECT_EQ(made.limits[0], "every line would be in use 120.0 % of the time at 1Gbit/s: 20.0 % too much");
  EXPECT_THAT(made.limits[1], HasSubstr("node a would need 270.0 %"));
}

// 0.8 us every 1 us; on the line into b, at half the rate, 1.6 us.
TEST(Plan, OfLinesThatDifferTheFullOneIsNamed) {
  config::RingConfig ring = small_ring(3);
  ring.nodes[1].link.rate = 500'000'000;
  const Plan made = plan(ring, {stream_from(0, 1, {kHundred}, 1us)});
  ASSERT_EQ(made.limits.size(), 2u);
  EXPECT_EQ(made.limits[0], "the line into b would be in use 160.0 % of the time at 500Mbit/s: 60.0 % too much");
}

// A packet of b: before its line of 1 Mbit/s the others' 524 bytes may be queued, 2 * 4.192 ms; its own
// 4.192 ms; at c and a one of theirs, 4.192 us each, and 3 us of delay. Its NC waits longer than that.
TEST(Plan, ATimeOutCoversTheQueueBeforeASlowLine) {
  config::RingConfig ring = small_ring(3);
  ring.nodes[2].link.rate = 1'000'000;
  ring.timeouts.send = 1ms;
  std::vector<Stream> streams;
  for (NodeId n{0}; n < 3; ++n) streams.push_back(stream_from(n, 0, {512}, 1s));
  const Plan made = plan(ring, streams);
  EXPECT_EQ(made.longest_lap, ns(3 * 4'192'000 + 2 * 4192 + 3000));
  EXPECT_TRUE(made.carried());
}

// While a's 524 bytes go out, packets of 13 bytes come in from the nine others: 117 in all. If the others' are as
// long, 524 bytes come in, beside one half in and one half out.
TEST(Plan, AnInsertionBufferHoldsWhatComesInWhileAnOwnPacketGoesOut) {
  std::vector<Stream> streams{stream_from(0, 1, {512}, 1ms)};
  for (NodeId n{1}; n < 10; ++n) streams.push_back(stream_from(n, 0, {1}, 1ms));
  EXPECT_EQ(plan(small_ring(10), streams).nodes[0].waiting, 117u);
  for (Stream& stream : streams) stream.packets = {512};
  EXPECT_EQ(plan(small_ring(10), streams).nodes[0].waiting, 3 * 524u);
}

// Behind a line ten times as fast as its own, a node may get a packet of every other node at once.
TEST(Plan, AnInsertionBufferBeforeASlowerLineMayBeTooSmall) {
  config::RingConfig ring = small_ring(12);
  ring.nodes[1].link.rate = 100'000'000;  // a -> b
  ring.limits.insertion_buffer = 8;
  std::vector<Stream> streams;
  for (NodeId n{0}; n < 12; ++n) streams.push_back(stream_from(n, 1, {512}, 10ms));
  const Plan made = plan(ring, streams);
  EXPECT_EQ(made.nodes[0].waiting, 11 * 524u);
  EXPECT_THAT(made.limits, ElementsAre("5764 bytes may wait in the insertion buffer of node a: "
                                       "limits.insertion_buffer, 8 packets of 524 bytes, is too small"));
}

TEST(Plan, AnInsertionBufferBeforeASlowerLineIsLargeEnoughIfItsSizeIsNotGiven) {
  config::RingConfig ring = small_ring(12);
  ring.nodes[1].link.rate = 100'000'000;  // a -> b
  std::vector<Stream> streams;
  for (NodeId n{0}; n < 12; ++n) streams.push_back(stream_from(n, 1, {512}, 10ms));
  EXPECT_THAT(plan(ring, streams).limits, ElementsAre());
}

TEST(Plan, AWaitLongerThanTheQueueTimeIsTooLong) {
  config::RingConfig ring = small_ring(2);
  ring.timeouts.queue = 1ms;
  // 1000 laps of 2.8 us are 2.8 ms.
  const Plan made = plan(ring, {stream_from(0, 1, std::vector<unsigned>(1000, kHundred), 1s)});
  EXPECT_THAT(made.limits, ElementsAre("'from 0' may wait longer than timeouts.queue, 1ms"));
}

TEST(Plan, TheVerdictNamesTheBusiestNodeAndLine) {
  config::RingConfig ring = small_ring(2);
  ring.nodes[0].link.rate = 500'000'000;  // b -> a
  const Plan made = plan(ring, {stream_from(0, 1, {kHundred}, 100us)});
  // T = 1.6 us on the slower line, d twice, nobody else sends: 3.6 us of 100; the slower line 1.6 of 100.
  EXPECT_EQ(verdict(ring, made),
            "The ring carries this. The busiest node, a, has a packet under way for at most 3.6 % of the time. The "
            "busiest line, the line into a, is in use for at most 1.6 %.\n");
  EXPECT_THAT(made.limits, IsEmpty());
}

TEST(Plan, LinesWithoutARateAreAssumed) {
  config::RingConfig ring = small_ring(2);
  EXPECT_FALSE(sim::assumes_lines(ring));
  ring.nodes[1].link.rate = 0;
  EXPECT_TRUE(sim::assumes_lines(ring));
  ring = sim::with_assumed_lines(ring, 100'000'000, 7us);
  EXPECT_EQ(ring.nodes[0].link.rate, 1'000'000'000u);
  EXPECT_EQ(ring.nodes[0].link.delay, 1us);
  EXPECT_EQ(ring.nodes[1].link.rate, 100'000'000u);
  EXPECT_EQ(ring.nodes[1].link.delay, 7us);
}

}  // namespace
}  // namespace limb_ring::study
