// Fold-back at one node, what comes and goes on its lines slice by slice. (protocol.md sections 8.8 to 8.12)
#include "core/lone_fold.h"
#include "core/copied_state.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Its own node would take it off; that one is dead, and bypassed by this one's input.
TEST_F(LoneFold, AWordOfABypassedNodeHasComeRoundAndEndsHere) {
  node.apply(input::InputUp{Line::second, 7_id}, Time{});
  hear(wire::FoldWordKind::begin, 6_id);
  EXPECT_TRUE(second().empty());
  receive_interrupt(Line::second, 0, 2);
  EXPECT_TRUE(second().empty()) << "nor does what follows it go round";
  hear(wire::FoldWordKind::begin, 0_id);
  EXPECT_FALSE(second().empty());
}

TEST_F(LoneFold, AWordOfTheNextNodeHasComeRoundIfThatNodeIsBypassed) {
  node.apply(input::InputUp{Line::second, 6_id}, Time{});
  hear(wire::FoldWordKind::begin, 5_id);
  EXPECT_TRUE(second().empty());
}

// Its `last` was lost: what comes on the first line waits no longer than the table of timers says.
TEST_F(LoneFold, TheFirstLineIsTakenAfterAWhileThoughTheSecondNeverEnds) {
  node.apply(input::InputLost{Line::first}, Time{});
  hear(wire::FoldWordKind::begin, 3_id);
  node.apply(input::InputUp{Line::first, 3_id}, Time{});
  receive_interrupt(Line::first, 0, 2);
  const Duration longest = std::min(node.settings().stall, node.settings().send_timeout() / 8);
  const Time due = Time{} + longest;
  node.apply(input::Timeout{}, due - Duration{1});
  EXPECT_EQ(node.counters().pins_pulled, 0u);
  second().clear();
  node.apply(input::Timeout{}, due);
  EXPECT_EQ(node.counters().pins_pulled, 1u);
  EXPECT_TRUE(second().empty()) << "no fold is left to tell of";
  EXPECT_EQ(node.input_line(), Line::first);
}

TEST_F(LoneFold, WhatFindsNoRoomOnAWholeRingIsDroppedNotHeld) {
  node.set_output_ready(Line::first, false);
  const Bytes packet = Foreign{1, 2}.with(pattern(512));
  for (int i = 0; i < 20; ++i)
    node.receive(Line::first, {wire::SliceKind::whole, {packet.data(), packet.size()}}, Time{});
  EXPECT_GT(node.counters().insertion_buffer_full, 0u);
}

TEST_F(LoneFold, AGapOfTheFirstLineBreaksOffWhatComesInOnIt) {
  const Bytes packet = Foreign{1, 2}.with(pattern(64));
  node.receive(Line::first, {wire::SliceKind::start, {packet.data(), wire::kHeaderSize}}, Time{});
  node.apply(input::InputGap{Line::first}, Time{});
  EXPECT_EQ(node.counters().broken_off_packets, 1u);
}

TEST_F(LoneFold, ALineThatIsUpAgainIsReadyThoughItWasNotWhenItWasLost) {
  node.set_output_ready(Line::first, false);
  node.apply(input::OutputLost{Line::first}, Time{});
  node.apply(input::OutputUp{Line::first, 5_id}, Time{});
  node.apply(input::Run{}, Time{});
  node.output(Line::first).clear();
  receive_interrupt(Line::first, 0, 2);
  node.apply(input::Run{}, Time{});
  EXPECT_FALSE(node.output(Line::first).empty());
}

// It turns forward as the packet that is on the second line ends.
TEST_F(LoneFold, AFirstLineThatTakesNothingIsGivenNothingOnceItIsTheOutputAgain) {
  const Bytes packet = Foreign{1, 2}.with(pattern(8));
  const auto receive = [&](wire::SliceKind kind, const Bytes& bytes) {
    node.receive(Line::first, {kind, {bytes.data(), bytes.size()}}, Time{});
    node.apply(input::Run{}, Time{});
  };
  hear(wire::FoldWordKind::deaf, 5_id);
  node.set_output_ready(Line::first, false);
  receive(wire::SliceKind::start, head_of(packet));
  hear(wire::FoldWordKind::hears, 5_id);
  ASSERT_EQ(node.output_line(), Line::second);
  receive(wire::SliceKind::end, tail_of(packet));
  ASSERT_EQ(node.output_line(), Line::first);
  node.output(Line::first).clear();
  receive(wire::SliceKind::whole, packet);
  EXPECT_TRUE(node.output(Line::first).empty());
}

TEST_F(LoneFold, TheSecondOutputsLossIsTheOutputsWhileItIsFolded) {
  node.apply(input::OutputLost{Line::first}, Time{});
  ASSERT_EQ(node.output_line(), Line::second);
  receive_interrupt(Line::first, 0, 2);
  EXPECT_EQ(node.counters().dropped_no_output, 0u);
  node.apply(input::OutputLost{Line::second}, Time{});
  receive_interrupt(Line::first, 1, 2);
  EXPECT_GT(node.counters().dropped_no_output, 0u);
}

// An own `begin` of that node comes each beacon period; what comes sooner has come round.
TEST_F(LoneFold, ABeginIsRepeatedUnlessItWasHeardLessThanHalfABeaconPeriodAgo) {
  const Duration half = node.settings().beacon / 2;
  hear(wire::FoldWordKind::begin, 6_id, Time{});
  second().clear();
  hear(wire::FoldWordKind::begin, 6_id, Time{} + half - Duration{1});
  EXPECT_TRUE(second().empty());
  hear(wire::FoldWordKind::begin, 6_id, Time{} + half);
  EXPECT_FALSE(second().empty());
}

struct LoneFoldWithoutBeacons : LoneFold {
  static Settings settings() {
    Settings s = LoneFold::settings();
    s.beacon = {};
    return s;
  }
  LoneFoldWithoutBeacons() : LoneFold(settings()) {}
};

TEST_F(LoneFoldWithoutBeacons, SaysItsWordsTenTimesASecond) {
  node.apply(input::InputLost{Line::first}, Time{});
  second().clear();
  node.apply(input::Timeout{}, Time{} + 100ms - Duration{1});
  EXPECT_TRUE(second().empty());
  node.apply(input::Timeout{}, Time{} + 100ms);
  EXPECT_FALSE(second().empty());
}

TEST_F(LoneFold, ANodeThatGoesOnFromAStateSaysItsWordsInTime) {
  node.apply(input::InputLost{Line::first}, Time{});
  second().clear();
  NetworkController other{node.settings(), Time{}};
  read_state(bytes_of(node), other);
  other.apply(input::Timeout{}, Time{} + node.settings().beacon);
  ASSERT_FALSE(other.output(Line::second).empty());
  EXPECT_EQ(wire::fold_word(wire::parse_slice(other.output(Line::second).view()).slice)->kind,
            wire::FoldWordKind::deaf);
}

TEST_F(LoneFold, AFoldNodeIsForgottenAfterFiveBeaconPeriodsAndThatIsTold) {
  hear(wire::FoldWordKind::begin, 6_id, Time{});
  second().clear();
  const Time due = Time{} + 5 * node.settings().beacon;
  node.apply(input::Timeout{}, due - Duration{1});
  EXPECT_TRUE(second().empty());
  node.apply(input::Timeout{}, due);
  ASSERT_FALSE(second().empty());
  EXPECT_EQ(wire::fold_word(wire::parse_slice(second().view()).slice)->kind, wire::FoldWordKind::lost);
}

// Its first output was never there, so it may be one that only starts later than the others.
TEST(FoldPermission, ANodeMayFoldATimeAfterItsStartEvenIfItsFirstLinesWereNeverBothUp) {
  const Settings settings = LoneFold::settings();
  NetworkController node(settings, Time{});
  node.apply(input::InputUp{Line::first, 3_id}, Time{});
  node.apply(input::InputUp{Line::second, 5_id}, Time{});
  node.apply(input::OutputUp{Line::second, 3_id}, Time{});
  const Time due = Time{} + settings.fold_permission;
  node.apply(input::Timeout{}, due - Duration{1});
  EXPECT_EQ(node.output_line(), Line::first);
  node.apply(input::Timeout{}, due);
  EXPECT_EQ(node.output_line(), Line::second);
}

// A node that starts over hears that the next one is deaf before its own input is up. It turned back without its words,
// and for ever where the `hears` was lost (seed 3730033071).
TEST(FoldPermission, ANodeThatTurnedBackBeforeSaysItsWordsWhenItMayFold) {
  NetworkController node(LoneFold::settings(), Time{});
  node.apply(input::OutputUp{Line::first, 5_id}, Time{});
  node.apply(input::InputUp{Line::second, 5_id}, Time{});
  node.apply(input::OutputUp{Line::second, 3_id}, Time{});
  wire::SliceWriter deaf;
  wire::put(deaf, {wire::FoldWordKind::deaf, 5_id});
  node.receive(Line::second, wire::parse_slice(deaf.view()).slice, Time{});
  ASSERT_EQ(node.output_line(), Line::second);
  for (const Line line : node.lines()) node.output(line).clear();
  node.apply(input::InputUp{Line::first, 3_id}, Time{});
  for (const Line line : node.lines()) {
    ASSERT_FALSE(node.output(line).empty());
    const auto word = wire::fold_word(wire::parse_slice(node.output(line).view()).slice);
    ASSERT_TRUE(word);
    EXPECT_EQ(word->kind, wire::FoldWordKind::begin);
    EXPECT_EQ(word->node, 4);
  }
}

TEST_F(LoneFold, AWordOfAnUnknownNodeIsIgnored) {
  hear(wire::FoldWordKind::begin, 200_id);
  EXPECT_TRUE(second().empty());
  EXPECT_EQ(node.counters().fold_discarded, 1u);
}

// It passed here before the line behind it broke, was turned back at node 6, and is on its way back when the line
// before this node breaks too.
TEST_F(LoneFold, WhatComesBackFromBeyondItsOwnBreakIsNotTakenAgain) {
  hear(wire::FoldWordKind::begin, 6_id);
  receive_interrupt(Line::first, 0, 2);
  receive_interrupt(Line::first, 1, 2);
  EXPECT_EQ(node.counters().pins_pulled, 2u);
  node.apply(input::InputLost{Line::first}, Time{});
  receive_interrupt(Line::second, 0, 5);
  EXPECT_EQ(node.counters().pins_pulled, 2u);
  EXPECT_EQ(node.counters().orphans_cut_off, 1u);
}

// Whoever takes it further on would wait for its end.
TEST_F(LoneFold, WhatBreaksOffOnTheSecondLineIsAbortedThereOnce) {
  const auto kinds = [this] {
    std::vector<wire::SliceKind> all;
    wire::each_slice(second().view(), [&all](const wire::Slice& slice) { all.push_back(slice.kind); });
    second().clear();
    return all;
  };
  hear(wire::FoldWordKind::begin, 6_id);
  second().clear();
  node.apply(input::InputGap{Line::second}, Time{});
  EXPECT_THAT(kinds(), IsEmpty()) << "nothing was under way";
  const std::array<std::uint8_t, wire::kHeaderSize> header{0, wire::kSop, 0, 1};
  node.receive(Line::second, {wire::SliceKind::start, {header.data(), header.size()}}, Time{});
  node.apply(input::InputGap{Line::second}, Time{});
  EXPECT_THAT(kinds(), ElementsAre(wire::SliceKind::start, wire::SliceKind::abort));
  node.apply(input::InputGap{Line::second}, Time{});
  EXPECT_THAT(kinds(), IsEmpty());
}

TEST_F(LoneFold, ANewNodeBehindTheFirstLineIsNotDeafBecauseTheLastOneWas) {
  hear(wire::FoldWordKind::deaf, 5_id);
  ASSERT_EQ(node.output_line(), Line::second);
  node.apply(input::OutputLost{Line::first}, Time{});
  node.apply(input::OutputUp{Line::first, 6_id}, Time{});
  EXPECT_EQ(node.output_line(), Line::first);
}

// A `hears` was lost, and the words on the second line stop at another node that has turned back: two such nodes stayed
// folded for ever. So a node asks the next one on the first line, each beacon period.
TEST_F(LoneFold, ANodeThatHasTurnedBackAsksTheNextOnTheFirstLineWhetherItHears) {
  hear(wire::FoldWordKind::deaf, 5_id);
  EXPECT_EQ(node.output_line(), Line::second);
  node.output(Line::first).clear();
  Time now{};
  for (int deadlines = 0; deadlines < 20 && node.output(Line::first).empty(); ++deadlines) {
    now = std::max(now, node.next_deadline(now));
    node.apply(input::Timeout{}, now);
    node.apply(input::Run{}, now);
    Event event;
    while (node.take_event(now, event)) {
    }
    second().clear();
  }
  ASSERT_FALSE(node.output(Line::first).empty());
  const auto word = wire::fold_word(wire::parse_slice(node.output(Line::first).view()).slice);
  ASSERT_TRUE(word);
  EXPECT_EQ(word->kind, wire::FoldWordKind::begin);
  EXPECT_EQ(word->node, 4);
}

TEST_F(LoneFold, ANodeThatHearsAnswersTheOneBefore) {
  wire::SliceWriter question;
  wire::put(question, {wire::FoldWordKind::begin, 3_id});
  node.receive(Line::first, wire::parse_slice(question.view()).slice, Time{});
  ASSERT_FALSE(second().empty());
  const auto word = wire::fold_word(wire::parse_slice(second().view()).slice);
  ASSERT_TRUE(word);
  EXPECT_EQ(word->kind, wire::FoldWordKind::hears);
  EXPECT_EQ(word->node, 4);
}

// As much as 254 nodes have under way, and no more, should packets ever go round if nobody strips.
TEST_F(LoneFold, WhatWaitsToBeRepeatedHasALimit) {
  hear(wire::FoldWordKind::begin, 6_id);
  const std::vector<std::uint8_t> packet(wire::kMaxDataPacketSize, 0x55);
  const wire::Slice slice{wire::SliceKind::whole, {packet.data(), packet.size()}};
  constexpr std::size_t kLap = 254 * wire::kMaxDataPacketSize;
  std::size_t given = 0;
  for (; given < kLap; given += packet.size()) node.receive(Line::second, slice, Time{});
  EXPECT_EQ(node.counters().fold_discarded, 0u);
  for (; given < 4 * kLap; given += packet.size()) node.receive(Line::second, slice, Time{});
  EXPECT_GT(node.counters().fold_discarded, 0u);
  EXPECT_LE(second().view().size, 257u * 1024);
}

/// With its header 512 bytes on a line.
struct Slice512 {
  const std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(512 - wire::kSliceHeaderSize, 0x55);
  wire::Slice operator()() const { return {wire::SliceKind::whole, {bytes.data(), bytes.size()}}; }
};

TEST_F(LoneFold, TheSliceThatReachesTheLimitIsRepeatedAndTheNextIsNot) {
  hear(wire::FoldWordKind::begin, 6_id);
  second().clear();
  const Slice512 slice;
  for (int i = 0; i < 512; ++i) node.receive(Line::second, slice(), Time{});
  EXPECT_EQ(second().view().size, 256u * 1024);
  EXPECT_EQ(node.counters().fold_discarded, 0u);
  node.receive(Line::second, slice(), Time{});
  EXPECT_EQ(second().view().size, 256u * 1024);
  EXPECT_EQ(node.counters().fold_discarded, 1u);
}

// The fold node is the one before, which has the word that it sends on the first line again still on its way.
TEST_F(LoneFold, WhatIsHeldWhileTheSecondLineDrainsHasALimit) {
  node.apply(input::InputLost{Line::first}, Time{});
  hear(wire::FoldWordKind::begin, 3_id);
  node.apply(input::InputUp{Line::first, 3_id}, Time{});
  const std::vector<std::uint8_t> bytes(512, 0x55);
  const wire::Slice slice{wire::SliceKind::more, {bytes.data(), bytes.size()}};
  for (int i = 0; i < 129; ++i) node.receive(Line::first, slice, Time{});  // the last one finds 64 KiB
  EXPECT_EQ(node.counters().fold_held_dropped, 0u);
  node.receive(Line::first, slice, Time{});
  EXPECT_EQ(node.counters().fold_held_dropped, 129u);
}

TEST_F(LoneFold, WhatIsHeldIsPartOfTheState) {
  node.apply(input::InputLost{Line::first}, Time{});
  hear(wire::FoldWordKind::begin, 3_id);
  node.apply(input::InputUp{Line::first, 3_id}, Time{});
  receive_interrupt(Line::first, 0, 2);
  NetworkController same{settings(), Time{}};
  read_state(bytes_of(node), same);
  wire::SliceWriter last;
  wire::put(last, {wire::FoldWordKind::last, 3_id});
  std::vector<std::uint64_t> passed_on;
  for (NetworkController* each : {&node, &same}) {
    const auto before = each->counters().relayed_interrupts;
    each->receive(Line::second, wire::parse_slice(last.view()).slice, Time{});
    each->apply(input::Run{}, Time{});
    passed_on.push_back(each->counters().relayed_interrupts - before);
  }
  EXPECT_THAT(passed_on, ElementsAre(1u, 1u)) << "not before the second line's last";
}

}  // namespace
}  // namespace limb_ring::core
