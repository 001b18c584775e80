#include "study/response.h"

#include "study/small_ring.h"
#include "support/node_literal.h"

namespace limb_ring::study {
namespace {

std::vector<Stream> one_from_each(unsigned nodes, unsigned bytes) {
  std::vector<Stream> streams;
  for (unsigned n = 0; n < nodes; ++n)
    streams.push_back(stream_from(static_cast<NodeId>(n), static_cast<NodeId>((n + 1) % nodes), {bytes}, 1s));
  return streams;
}

config::RingConfig paper_ring() {
  config::RingConfig ring = small_ring(16);
  for (config::NodeConfig& node : ring.nodes) node.link.delay = 512ns;
  return ring;
}

// protocol.md section 7.2: N (T + d) = 75.264 us, h hops: h (T + d); INTP: N (d + 96 ns + 64 ns) = 10.752 us.
TEST(Laps, AreThoseOfThePaperOnItsRing) {
  const Laps laps(paper_ring(), one_from_each(16, 512));
  EXPECT_EQ(laps.data(0_id, 0_id, 512), ns(75264));
  EXPECT_EQ(laps.data(0_id, 3_id, 512), ns(3 * (4192 + 512)));
  EXPECT_EQ(laps.data(14_id, 1_id, 512), ns(3 * (4192 + 512)));
  EXPECT_EQ(laps.data_ahead(0_id), ns(4192));
  EXPECT_EQ(laps.interrupt(0_id, 0_id), ns(10752));
}

// Node 0 sends 100 bytes (0.8 us), node 1 200 (1.6 us), node 2 nothing.
TEST(Laps, CountOfEachOtherNodeItsLargestPacket) {
  const Laps laps(small_ring(3), {stream_from(0, 1, {kHundred}, 1s), stream_from(1, 0, {188, kHundred}, 1s)});
  EXPECT_EQ(laps.data(0_id, 0_id, kHundred), ns(800 + 3 * 1000 + 1600));
  EXPECT_EQ(laps.data(0_id, 1_id, kHundred), ns(800 + 1000));
  EXPECT_EQ(laps.data(0_id, 2_id, kHundred), ns(800 + 2 * 1000 + 1600));
  EXPECT_EQ(laps.data(1_id, 1_id, kHundred), ns(800 + 3 * 1000 + 800));
  EXPECT_EQ(laps.data_ahead(0_id), ns(1600));
  EXPECT_EQ(laps.data_ahead(1_id), ns(800));
}

// An odd byte is sent with trailer and CRC: 9 bytes, 72 ns, before an INTP. 2 * (1000 + 96 + 72).
TEST(Laps, InterruptsWaitForOddBytesToo) {
  const Laps laps(small_ring(2), {stream_from(0, 1, {5}, 1s)});
  EXPECT_EQ(laps.interrupt(0_id, 0_id), ns(2336));
  EXPECT_EQ(laps.interrupt(0_id, 1_id), ns(1000 + 96 + 72));
}

// The line b -> c has half the rate: at b the packets of b and c may be queued, 1.6 us each there. At c, whose
// line is faster again, c's own (0.8 us). T = 1.6 us on the slowest. d = 3 * 1 us.
TEST(Laps, OnALineThatNarrowsEverybodyMayBeAhead) {
  config::RingConfig ring = small_ring(3);
  ring.nodes[2].link.rate = 500'000'000;
  const Laps laps(ring, one_from_each(3, kHundred));
  EXPECT_EQ(laps.data(0_id, 0_id, kHundred), ns(1600 + 3000 + 2 * 1600 + 800));
  EXPECT_EQ(laps.data(0_id, 1_id, kHundred), ns(800 + 1000));
  EXPECT_EQ(laps.data_ahead(0_id), ns(1600));
  // Of node 1 itself: at its own line packets of a and c may be queued before each of its packets.
  EXPECT_EQ(laps.data(1_id, 2_id, kHundred), ns(1600 + 1000 + 2 * 1600));
}

TEST(Laps, LinesMayHaveDelaysOfTheirOwn) {
  config::RingConfig ring = small_ring(3);
  ring.nodes[1].link.delay = 5us;  // the line a -> b
  const Laps laps(ring, {stream_from(0, 1, {kHundred}, 1s)});
  EXPECT_EQ(laps.data(0_id, 1_id, kHundred), ns(800 + 5000));
  EXPECT_EQ(laps.data(0_id, 0_id, kHundred), ns(800 + 7000));
}

// A lap of 0.8 + 2 = 2.8 us alone. One INTP in 1 ms: 96 ns. One in 2 us that lives 1 us: n((lap + 1) / 2) + 1 are
// under way: lap 2.8: 2, 2.992: 2.
TEST(Laps, InterruptsUnderWayAdd96NanosecondsEach) {
  Laps rare(small_ring(2), {stream_from(0, 1, {kHundred}, 1s)});
  EXPECT_TRUE(rare.set_interrupts({{1ms, 10us}}));
  EXPECT_EQ(rare.data(0_id, 0_id, kHundred), ns(2800 + 96));
  Laps often(small_ring(2), {stream_from(0, 1, {kHundred}, 1s)});
  EXPECT_TRUE(often.set_interrupts({{2us, 1us}}));
  EXPECT_EQ(often.data(0_id, 0_id, kHundred), ns(2800 + 2 * 96));
}

TEST(Laps, InterruptsThatFillTheLineLeaveNoRoomForData) {
  Laps laps(small_ring(2), {stream_from(0, 1, {kHundred}, 1s)});
  EXPECT_FALSE(laps.set_interrupts({{96ns, 1us}}));
}

}  // namespace
}  // namespace limb_ring::study
