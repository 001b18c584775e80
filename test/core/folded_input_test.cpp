// A node that takes its packets from the second line, and how it comes back to the first. (protocol.md section 8.9)
#include "core/copied_state.h"
#include "core/lone_fold.h"

namespace limb_ring::core {
namespace {

// The nodes behind node 3 are dead, so what comes on the second line was turned back at node 1.
struct FoldedAtNodeOne : LoneFold {
  using LoneFold::LoneFold;
  void SetUp() override {
    LoneFold::SetUp();
    node.apply(input::InputLost{Line::first}, Time{});
    hear(wire::FoldWordKind::begin, 1_id);
    node.apply(input::InputUp{Line::first, 3_id}, Time{});
    second().clear();
  }
  /// For the end of the packet on the second line.
  Duration longest_wait() const { return std::min(node.settings().stall, node.settings().send_timeout() / 8); }
};

TEST_F(FoldedAtNodeOne, TheSecondLineIsTakenUntilTheFirstHasSpoken) {
  receive_interrupt(Line::second, 0, 5);
  EXPECT_EQ(node.input_line(), Line::second);
  receive_interrupt(Line::first, 1, 2);
  EXPECT_EQ(node.input_line(), Line::first) << "nothing is under way on the second";
  EXPECT_EQ(node.counters().pins_pulled, 2u);
}

TEST_F(FoldedAtNodeOne, IsFoldedUntilItTakesTheFirstLineAgain) {
  EXPECT_TRUE(node.input_folded());
  receive_interrupt(Line::first, 1, 2);
  EXPECT_FALSE(node.input_folded());
  EXPECT_FALSE(NetworkController(SoloNode::settings({}, [](Settings&) {}), Time{}).input_folded()) << "it cannot fold";
}

/// Packets on the second line have left no room; then the first one speaks.
struct FoldedWithoutRoom : FoldedAtNodeOne {
  using FoldedAtNodeOne::FoldedAtNodeOne;
  const Bytes packet = Foreign{7, 2}.with(pattern(512));
  void SetUp() override {
    FoldedAtNodeOne::SetUp();
    node.set_output_ready(Line::first, false);
    for (unsigned i = 0; i < node.settings().insertion_buffer; ++i)
      node.receive(Line::second, {wire::SliceKind::whole, {packet.data(), packet.size()}}, Time{});
  }
  void TearDown() override {
    EXPECT_EQ(node.input_line(), Line::first);
    EXPECT_EQ(node.counters().insertion_buffer_full, 0u);
  }
};

TEST_F(FoldedWithoutRoom, APacketFromTheFirstLineWaits) {
  node.receive(Line::first, {wire::SliceKind::whole, {packet.data(), packet.size()}}, Time{});
}

TEST_F(FoldedWithoutRoom, APacketInPiecesWaitsToo) {
  node.receive(Line::first, {wire::SliceKind::start, {packet.data(), wire::kHeaderSize}}, Time{});
}

TEST_F(FoldedAtNodeOne, ANodeThatGoesOnFromAStateWaitsForTheEndOfWhatComesInOnTheSecondLine) {
  const Bytes packet = Foreign{7, 2}.with(pattern(64));
  node.receive(Line::second, {wire::SliceKind::start, {packet.data(), wire::kHeaderSize}}, Time{});
  NetworkController other{node.settings(), Time{}};
  read_state(bytes_of(node), other);
  const Bytes interrupt = foreign_interrupt(1, wire::kBroadcast, 0);
  other.receive(Line::first, {wire::SliceKind::interrupt, {interrupt.data(), interrupt.size()}}, Time{});
  EXPECT_EQ(other.input_line(), Line::second);
}

TEST_F(FoldedAtNodeOne, HoldsSixtyFourKibibytesOfTheFirstLineAndDropsThemIfMoreCome) {
  const Bytes packet = Foreign{7, 2}.with(pattern(512));
  node.receive(Line::second, {wire::SliceKind::start, {packet.data(), wire::kHeaderSize}}, Time{});
  const auto hold = [&](std::size_t bytes) {
    node.receive(Line::first, {wire::SliceKind::more, {packet.data(), bytes}}, Time{});
  };
  for (int i = 0; i < 128; ++i) hold(512);
  hold(4);
  EXPECT_EQ(node.counters().fold_held_dropped, 0u);
  hold(4);
  EXPECT_EQ(node.counters().fold_held_dropped, 129u);
  EXPECT_EQ(node.counters().broken_off_packets, 1u);
}

/// The same with lines that have a data rate.
struct PacedFoldWithoutRoom : FoldedWithoutRoom {
  void SetUp() override {
    FoldedWithoutRoom::SetUp();
    node.set_output_ready(Line::first, true);
  }
  PacedFoldWithoutRoom() : FoldedWithoutRoom(paced()) {}
  static Settings paced() {
    Settings s = settings();
    s.byte_time_in = s.byte_time_out = std::chrono::nanoseconds(80);
    return s;
  }
};

// As many packets come as go, so that some are held all the time: the limit is one of what waits, not of what came.
TEST_F(PacedFoldWithoutRoom, AFullLineIsTakenBackWithoutALoss) {
  const Duration packet_time = node.settings().byte_time_out * static_cast<std::int64_t>(packet.size());
  node.receive(Line::first, {wire::SliceKind::whole, {packet.data(), packet.size()}}, Time{});
  ASSERT_EQ(node.input_line(), Line::first);
  ASSERT_TRUE(node.holds_packets());
  Time now{};
  for (int packets = 0; packets < 500; ++packets) {
    for (const Time next = now + packet_time; now < next; now += packet_time / 8) {
      node.apply(input::Timeout{}, now);
      node.apply(input::Run{}, now);
      node.output(Line::first).clear();
      node.output(Line::second).clear();
    }
    node.receive(Line::first, {wire::SliceKind::whole, {packet.data(), packet.size()}}, now);
  }
  EXPECT_EQ(node.counters().fold_held_dropped, 0u);
  EXPECT_GT(node.counters().relayed_data, 480u);
}

TEST_F(FoldedAtNodeOne, WhatItHoldsIsDroppedWithTheLineItCameFrom) {
  const Bytes packet = Foreign{7, 2}.with(pattern(64));
  node.receive(Line::second, {wire::SliceKind::start, {packet.data(), wire::kHeaderSize}}, Time{});
  receive_interrupt(Line::first, 1, 2);
  node.apply(input::InputLost{Line::first}, Time{});
  EXPECT_EQ(node.counters().fold_held_dropped, 1u);
  node.apply(input::InputUp{Line::first, 3_id}, Time{});
  node.apply(input::InputLost{Line::first}, Time{});
  EXPECT_EQ(node.counters().fold_held_dropped, 1u) << "nothing is held any more";
}

TEST_F(FoldedAtNodeOne, ANodeThatTakesTheFirstLineAgainTellsOfTheFoldThatIsLeft) {
  receive_interrupt(Line::first, 1, 2);
  ASSERT_FALSE(second().empty());
  const auto word = wire::fold_word(wire::parse_slice(second().view()).slice);
  ASSERT_TRUE(word);
  EXPECT_EQ(word->kind, wire::FoldWordKind::begin);
  EXPECT_EQ(word->node, 1);
}

// The packet on the second line never ended, and was broken off as the first line was taken.
TEST_F(FoldedAtNodeOne, WhatWasLeftOpenOnTheSecondLineHoldsNobodyUpTheNextTime) {
  const Bytes packet = Foreign{7, 2}.with(pattern(64));
  node.receive(Line::second, {wire::SliceKind::start, {packet.data(), wire::kHeaderSize}}, Time{});
  receive_interrupt(Line::first, 1, 2);
  ASSERT_EQ(node.input_line(), Line::second) << "it waits for the packet's end";
  const Time later = Time{} + longest_wait();
  node.apply(input::Timeout{}, later);
  ASSERT_EQ(node.input_line(), Line::first);
  EXPECT_EQ(node.counters().broken_off_packets, 1u);
  node.apply(input::InputLost{Line::first}, later);
  hear(wire::FoldWordKind::begin, 1_id, later);
  node.apply(input::InputUp{Line::first, 3_id}, later);
  ASSERT_EQ(node.input_line(), Line::second);
  receive_interrupt(Line::first, 2, 2);
  EXPECT_EQ(node.input_line(), Line::first);
}

TEST_F(FoldedAtNodeOne, WaitsForThePacketsEndAsLongThoughTheFirstLineWasLostMeanwhile) {
  const Bytes packet = Foreign{7, 2}.with(pattern(64));
  node.receive(Line::second, {wire::SliceKind::start, {packet.data(), wire::kHeaderSize}}, Time{});
  receive_interrupt(Line::first, 1, 2);
  const Time later = Time{} + longest_wait();
  node.apply(input::InputLost{Line::first}, later - Duration{1});
  node.apply(input::InputUp{Line::first, 3_id}, later - Duration{1});
  const Bytes interrupt = foreign_interrupt(1, wire::kBroadcast, 0, 2);
  node.receive(Line::first, {wire::SliceKind::interrupt, {interrupt.data(), interrupt.size()}}, later - Duration{1});
  node.apply(input::Timeout{}, later);
  EXPECT_EQ(node.input_line(), Line::second);
}

}  // namespace
}  // namespace limb_ring::core
