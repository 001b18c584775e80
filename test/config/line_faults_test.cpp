// What each fault does to the packets that pass, and that they are hit whole.
#include "config/line_rig.h"

namespace limb_ring::fault {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::IsEmpty;

TEST(LineFaults, AreNoneAtFirstAndLetEverythingPass) {
  LineRig line;
  EXPECT_TRUE(line.faults.idle());
  line.whole(1);
  line.start(2);
  line.interrupt(5);
  line.more();
  line.end();
  EXPECT_THAT(line.came(), ElementsAre("1", "start 2", "INTP 5", "more", "end"));
  EXPECT_EQ(line.faults.next_deadline(), core::kNever);
  EXPECT_TRUE(line.faults.idle());
}

TEST(LineFaults, DropTakesTheNextPacketsAndIsOver) {
  LineRig line;
  line.begin("drop hip -> knee packets=2");
  for (unsigned i = 1; i <= 4; ++i) line.whole(i);
  EXPECT_THAT(line.came(), ElementsAre("3", "4"));
  EXPECT_EQ(line.faults.counters().line_dropped, 2u);
  EXPECT_TRUE(line.faults.idle());
}

TEST(LineFaults, DropTakesAllPartsOfADatpAndLeavesTheIntpInsideIt) {
  LineRig line;
  line.begin("drop hip -> knee packets=1");
  line.start(1);
  line.interrupt(5);
  line.more();
  line.end();
  EXPECT_THAT(line.came(), ElementsAre("INTP 5"));
}

TEST(LineFaults, DropMayTakeOnlyTheIntp) {
  LineRig line;
  line.start(1);
  line.begin("drop hip -> knee packets=1");
  line.interrupt(5);
  line.end();
  EXPECT_THAT(line.came(), ElementsAre("start 1", "end"));
}

TEST(LineFaults, CorruptFlipsOneBitWhichTheCrcShows) {
  LineRig line;
  line.begin("corrupt hip -> knee packets=2");
  line.whole(1);
  line.interrupt(5);
  line.whole(2);
  EXPECT_THAT(line.came(), ElementsAre(EndsWith("!"), EndsWith("!"), "2"));
  EXPECT_EQ(line.faults.counters().line_corrupted, 2u);
}

/// How often each bit of a slice comes out wrong, of many that go onto a line with `corrupt`.
std::vector<unsigned> bits_damaged(SliceKind kind, std::size_t size) {
  LineFaults faults(1);
  faults.begin(from_words("corrupt hip -> knee", kNodes), Time{});
  const std::vector<std::uint8_t> bytes(size);
  std::vector<unsigned> wrong(8 * size);
  for (unsigned i = 0; i < 40 * size; ++i) {
    wire::SliceWriter out;
    faults.pass({kind, {bytes.data(), bytes.size()}}, Time{});
    faults.take(Time{}, out);
    unsigned in_this = 0;
    wire::each_slice(out.view(), [&](const wire::Slice& slice) {
      for (std::size_t bit = 0; bit < wrong.size(); ++bit)
        if ((slice.bytes[bit / 8] >> bit % 8 & 1) != 0) ++wrong[bit], ++in_this;
    });
    EXPECT_EQ(in_this, 1u);
  }
  return wrong;
}

TEST(LineFaults, CorruptMayHitAnyBitBehindTheHeader) {
  struct Kind {
    SliceKind kind;
    std::size_t size, first;
  };
  for (const Kind& kind : {Kind{SliceKind::whole, 28, 4}, Kind{SliceKind::interrupt, 12, 4}}) {
    const std::vector<unsigned> wrong = bits_damaged(kind.kind, kind.size);
    for (std::size_t bit = 0; bit < wrong.size(); ++bit) EXPECT_EQ(wrong[bit] != 0, bit / 8 >= kind.first) << bit;
  }
}

TEST(LineFaults, CorruptHitsThePacketOfSeveralSlicesInItsLastSlice) {
  LineRig line;
  line.begin("corrupt hip -> knee packets=1");
  line.start(1);
  line.more();
  line.end();
  EXPECT_THAT(line.came(), ElementsAre("start 1", "more", "end!"));
}

TEST(LineFaults, TruncateEndsADatpInAnAbortAndSparesIntps) {
  LineRig line;
  line.begin("truncate hip -> knee packets=2");
  line.whole(1);
  line.interrupt(5);
  line.start(2);
  line.more();
  line.end();
  EXPECT_THAT(line.came(), ElementsAre("start 1", "abort", "INTP 5", "start 2", "more", "abort"));
  EXPECT_EQ(line.faults.counters().line_truncated, 2u);
}

TEST(LineFaults, DuplicatePutsTheWholePacketBehindItself) {
  LineRig line;
  line.begin("duplicate hip -> knee packets=3");
  line.whole(1);
  line.start(2);
  line.interrupt(5);
  line.more();
  line.end();
  EXPECT_THAT(line.came(), ElementsAre("1", "1", "start 2", "INTP 5", "INTP 5", "more", "end", "2"));
  EXPECT_EQ(line.faults.counters().line_duplicated, 3u);
}

TEST(LineFaults, ReorderLosesWhatComesLateAsTheSequenceCheckDoes) {
  LineRig line;
  line.begin("reorder hip -> knee packets=1");
  line.whole(1);
  line.whole(2);
  EXPECT_THAT(line.came(), ElementsAre("2"));
  EXPECT_EQ(line.faults.counters().line_reordered, 1u);
}

TEST(LineFaults, ReorderOfAnIntpAbortsTheDatpItWasIn) {
  LineRig line;
  line.begin("drop hip -> knee packets=1 after=1s");  // only so that the line looks at what passes
  line.start(1);
  line.begin("reorder hip -> knee packets=1");
  line.interrupt(5);
  line.more();
  line.end();
  line.whole(2);
  EXPECT_THAT(line.came(), ElementsAre("start 1", "abort", "2"));
  EXPECT_EQ(line.faults.counters().line_aborted, 1u);
}

TEST(LineFaults, CutTakesTheLineDownUntilItIsHealed) {
  LineRig line;
  line.begin("cut hip -> knee");
  line.run_for(0ns);
  EXPECT_TRUE(line.cut);
  line.whole(1);
  line.begin("heal hip -> knee");
  line.run_for(0ns);
  EXPECT_FALSE(line.cut);
  line.whole(2);
  EXPECT_THAT(line.came(), ElementsAre("2"));
  EXPECT_EQ(line.faults.counters().line_cut, 1u);
}

TEST(LineFaults, ADatpThatMeetsACutLosesItsRestToo) {
  LineRig line;
  line.start(1);
  line.begin("cut hip -> knee for=1ms");
  line.more();
  line.run_for(1ms);
  line.end();
  line.whole(2);
  EXPECT_THAT(line.came(), ElementsAre("start 1", "2"));
}

TEST(LineFaults, FlapIsCutForTheFirstHalfOfEachPeriod) {
  LineRig line;
  line.begin("flap hip -> knee every=10ms for=25ms");
  std::vector<bool> cut;
  line.run_for(1ms);
  for (int i = 0; i < 7; ++i) {
    cut.push_back(line.cut);
    line.run_for(5ms);
  }
  EXPECT_THAT(cut, ElementsAre(true, false, true, false, true, false, false));
  EXPECT_TRUE(line.faults.idle());
}

TEST(LineFaults, BeginAfterADelayAndEndAfterATime) {
  LineRig line;
  line.begin("drop hip -> knee after=1ms for=1ms");
  line.whole(1);
  line.run_for(1ms);
  line.whole(2);
  line.run_for(1ms);
  line.whole(3);
  EXPECT_THAT(line.came(), ElementsAre("1", "3"));
}

TEST(LineFaults, BeginWhenANodeHasDeliveredANumberOfPackets) {
  LineRig line;
  const NodeId ankle{2};
  line.begin("cut hip -> knee after_packets=2 of=ankle");
  line.whole(1, ankle);
  line.whole(2);
  line.whole(3, ankle, static_cast<std::uint8_t>(wire::Channel::control));
  EXPECT_TRUE(line.faults.list(line.now)[0].waits);
  EXPECT_FALSE(line.cut);
  line.whole(4, ankle);
  line.run_for(0ns);
  EXPECT_TRUE(line.cut);
  EXPECT_THAT(line.came(), ElementsAre("1", "2", "3", "4"));
}

TEST(LineFaults, AreListedAndRemovedOneByOne) {
  LineRig line;
  const LineFaults::Id drop = line.begin("drop hip -> knee");
  line.begin("corrupt hip -> knee");
  line.whole(1);
  const auto listed = line.faults.list(line.now);
  ASSERT_EQ(listed.size(), 2u);
  EXPECT_EQ(listed[0].hits, 1u);
  EXPECT_EQ(listed[1].hits, 0u);
  EXPECT_TRUE(line.faults.remove(drop));
  EXPECT_FALSE(line.faults.remove(drop));
  line.whole(2);
  EXPECT_THAT(line.came(), ElementsAre("2!"));
}

// Two of the same seed, one of another; one in three of 100 packets is some 33.
TEST(LineFaults, WithTheSameSeedDoTheSameDamage) {
  const auto damage = [](std::uint64_t seed) {
    LineRig line(seed);
    line.begin("drop hip -> knee once_in=3");
    line.begin("corrupt hip -> knee once_in=3");
    for (unsigned i = 0; i < 100; ++i) line.whole(i);
    return line.came();
  };
  EXPECT_EQ(damage(7), damage(7));
  EXPECT_NE(damage(7), damage(8));
  EXPECT_GT(damage(7).size(), 50u);
  EXPECT_LT(damage(7).size(), 80u);
}

TEST(LineFaults, AFaultsOwnSeedTakesPrecedenceOverTheLines) {
  const auto damage = [](std::uint64_t seed, const std::string& fault) {
    LineRig line(seed);
    line.begin(fault);
    for (unsigned i = 0; i < 100; ++i) line.whole(i);
    return line.came();
  };
  EXPECT_EQ(damage(1, "drop hip -> knee once_in=3 seed=9"), damage(2, "drop hip -> knee once_in=3 seed=9"));
  EXPECT_NE(damage(1, "drop hip -> knee once_in=3 seed=9"), damage(1, "drop hip -> knee once_in=3 seed=10"));
}

}  // namespace
}  // namespace limb_ring::fault
