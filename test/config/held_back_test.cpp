// Faults that make packets late: order is kept, and what is held back has a limit.
#include "config/line_rig.h"

namespace limb_ring::fault {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr Duration kMillisecond = 1ms;

TEST(HeldBack, DelayMakesEveryPacketLaterByItsValue) {
  LineRig line;
  line.begin("delay hip -> knee delay=2ms");
  line.whole(1);
  line.run_for(kMillisecond);
  line.whole(2);
  EXPECT_THAT(line.came(), IsEmpty());
  EXPECT_EQ(line.faults.next_deadline(), Time{} + 2ms);
  line.run_for(kMillisecond);
  EXPECT_THAT(line.came(), ElementsAre("1"));
  line.run_for(kMillisecond);
  EXPECT_THAT(line.came(), ElementsAre("2"));
  EXPECT_EQ(line.faults.counters().line_delayed, 2u);
}

TEST(HeldBack, APacketIsNeverOvertakenByOneWithLessDelay) {
  LineRig line;
  line.begin("delay hip -> knee delay=1ms packets=1");
  line.whole(1);
  line.whole(2);
  EXPECT_THAT(line.came(), IsEmpty());
  line.run_for(kMillisecond);
  EXPECT_THAT(line.came(), ElementsAre("1", "2"));
  EXPECT_EQ(line.faults.counters().line_held, 1u);
  EXPECT_TRUE(line.faults.idle());
}

TEST(HeldBack, JitterStaysBelowItsBoundAndKeepsOrder) {
  LineRig line;
  line.begin("delay hip -> knee jitter=1ms");
  std::vector<std::string> sent;
  for (unsigned i = 0; i < 50; ++i) {
    line.whole(i);
    sent.push_back(std::to_string(i));
    line.run_for(Duration{10us});
  }
  line.run_for(kMillisecond);
  EXPECT_EQ(line.came(), sent);
}

TEST(HeldBack, StallKeepsAllAndThenGoesOnInOrder) {
  LineRig line;
  line.begin("stall hip -> knee for=1ms");
  line.whole(1);
  line.interrupt(5);
  line.put({SliceKind::idle, {}});
  line.whole(2);
  EXPECT_THAT(line.came(), IsEmpty());
  line.run_for(kMillisecond);
  EXPECT_THAT(line.came(), ElementsAre("1", "INTP 5", "2"));
  EXPECT_EQ(line.faults.counters().line_held, 3u);
  EXPECT_TRUE(line.faults.idle());
}

TEST(HeldBack, AStallWithoutAnEndIsEndedByHealing) {
  LineRig line;
  line.begin("stall hip -> knee");
  line.whole(1);
  EXPECT_EQ(line.faults.next_deadline(), core::kNever);
  line.begin("heal hip -> knee");
  line.run_for(0ns);
  EXPECT_THAT(line.came(), ElementsAre("1"));
}

// 28 bytes at 1 Mbit/s are 224 us, of which the first begins at once.
TEST(HeldBack, RateLetsNoMoreThroughThanItSays) {
  LineRig line;
  line.begin("rate hip -> knee rate=1Mbit/s");
  line.whole(1);
  line.whole(2);
  line.run_for(Duration{223us});
  EXPECT_THAT(line.came(), IsEmpty());
  line.run_for(Duration{1us});
  EXPECT_THAT(line.came(), ElementsAre("1"));
  line.run_for(Duration{224us});
  EXPECT_THAT(line.came(), ElementsAre("2"));
}

// At 8 ns a byte 28 bytes take 224 ns.
TEST(HeldBack, PacketsHeldByAStallGoOnNoFasterThanTheLine) {
  LineRig line(1, Duration{8ns});
  line.begin("stall hip -> knee for=1ms");
  for (unsigned i = 1; i <= 3; ++i) line.whole(i);
  line.run_for(kMillisecond + Duration{2 * 224ns});
  EXPECT_THAT(line.came(), ElementsAre("1", "2"));
  line.run_for(Duration{224ns});
  EXPECT_THAT(line.came(), ElementsAre("3"));
}

TEST(HeldBack, BeyondTheLimitPacketsAreDroppedWholeAndCounted) {
  LineRig line;
  line.begin("stall hip -> knee for=1ms");
  const std::size_t size = wire::kSliceHeaderSize + 16 + wire::kOverhead;
  const std::size_t most = LineFaults::kLimit / size;
  for (std::size_t i = 0; i < most + 100; ++i) line.whole(1);
  line.start(2);
  line.more();
  line.end();
  EXPECT_GE(line.faults.counters().line_full, 101u);
  line.run_for(kMillisecond);
  const auto came = line.came();
  EXPECT_LE(came.size(), most);
  EXPECT_EQ(came.size() + line.faults.counters().line_full, most + 101);
  EXPECT_THAT(came, testing::Each("1"));
}

TEST(HeldBack, NothingOfALineThatIsGoneComesOutOfTheNextOne) {
  LineRig line;
  line.begin("delay hip -> knee delay=1ms");
  line.whole(1);
  line.faults.line_lost();
  line.run_for(2 * kMillisecond);
  EXPECT_THAT(line.came(), IsEmpty());
  EXPECT_EQ(line.faults.counters().line_lost, 1u);
}

TEST(HeldBack, ACutLosesWhatWasHeldBack) {
  LineRig line;
  line.begin("delay hip -> knee delay=2ms");
  line.begin("cut hip -> knee after=1ms for=1us");
  line.whole(1);
  line.run_for(3 * kMillisecond);
  EXPECT_THAT(line.came(), IsEmpty());
  EXPECT_EQ(line.faults.counters().line_lost, 1u);
}

}  // namespace
}  // namespace limb_ring::fault
