// One node of a ring that folds back, its four lines in the hands of the test. (protocol.md sections 8.8 to 8.12)
#include "core/solo_node.h"
#include "wire/control_message.h"

namespace limb_ring::core {
namespace {

using testing::Contains;
using testing::Not;
using testing::SizeIs;
using wire::FoldWordKind;
using wire::SliceKind;

/// Node 1 of 4.
struct FoldWords : testing::Test {
  static Settings settings() {
    Settings s;
    s.id = 1_id;
    s.order = {0_id, 1_id, 2_id, 3_id};
    s.fold_back = true;
    return s;
  }
  void run() {
    node.apply(input::Timeout{}, now);
    node.apply(input::Run{}, now);
  }
  void run_for(Duration duration) {
    const Time until = now + duration;
    for (Time next = node.next_deadline(now); next <= until; next = node.next_deadline(now)) {
      now = std::max(now, next);
      run();
      for (const Line line : node.lines()) collect(line);
      for (Event event; node.take_event(now, event);) {
      }
    }
    now = until;
  }
  void word(Line line, FoldWordKind kind, NodeId of) {
    wire::SliceWriter said;
    wire::put(said, {kind, of});
    wire::each_slice(said.view(), [&](const wire::Slice& slice) { node.receive(line, slice, now); });
  }
  void collect(Line line) { collected[static_cast<std::size_t>(line)].take(node.output(line)); }
  /// What was put onto that line since the last call.
  std::vector<Bytes> given(Line line, SliceKind kind = SliceKind::fold) {
    collect(line);
    wire::SliceWriter& slices = collected[static_cast<std::size_t>(line)];
    std::vector<Bytes> all;
    wire::each_slice(slices.view(), [&](const wire::Slice& slice) {
      if (slice.kind == kind) all.emplace_back(slice.bytes.begin(), slice.bytes.end());
    });
    slices.clear();
    return all;
  }
  static Bytes bytes(FoldWordKind kind, NodeId of) {
    const auto word = static_cast<std::uint8_t>(kind);
    return {word, of, wire::fold_check(word, of)};
  }
  void both_lines_up() {
    for (const Line line : node.lines()) {
      node.apply(input::InputUp{line, line == Line::first ? 0_id : 2_id}, now);
      node.apply(input::OutputUp{line, line == Line::first ? 2_id : 0_id}, now);
    }
    run();
  }

  Time now{};
  std::array<wire::SliceWriter, 2> collected;
  NetworkController node{settings(), now};
};

// Its neighbours would take the line for whole again (seed 38 of test/model).
TEST_F(FoldWords, TheFirstBeaconOfANewFoldSaysThatItIsOne) {
  both_lines_up();
  node.apply(input::InputLost{Line::first}, now);
  run_for(1050ms);
  ASSERT_EQ(node.membership().state(), NodeState::open_chain);
  given(Line::first);
  word(Line::second, FoldWordKind::begin, 0_id);
  run_for(1ms);
  const auto packets = given(Line::first, SliceKind::whole);
  ASSERT_FALSE(packets.empty());
  const auto beacon = wire::decode_beacon({packets[0].data() + 4, packets[0].size() - 12});
  ASSERT_TRUE(beacon);
  EXPECT_EQ(beacon->input, wire::LinkState::folded);
}

// The others on the second line would look for the fold at the wrong place (seed 48 of test/model).
TEST_F(FoldWords, ANodeThatSendsBackItselfAnnouncesNoOtherFold) {
  both_lines_up();
  node.apply(input::OutputLost{Line::first}, now);
  node.apply(input::InputLost{Line::first}, now);
  word(Line::second, FoldWordKind::begin, 3_id);
  node.apply(input::InputUp{Line::first, 0_id}, now);
  given(Line::second);
  word(Line::first, FoldWordKind::last, 0_id);
  ASSERT_EQ(node.input_line(), Line::first);
  ASSERT_EQ(node.output_line(), Line::second);
  EXPECT_THAT(given(Line::second), Not(Contains(bytes(FoldWordKind::begin, 3_id))));
  node.apply(input::OutputUp{Line::first, 2_id}, now);
  EXPECT_THAT(given(Line::second), Contains(bytes(FoldWordKind::begin, 3_id))) << "now it repeats";
}

// Words of the next node came before there was a line to it (seed 222 of test/model).
TEST_F(FoldWords, NothingIsRelayedOntoALineThatHasNotBeenUp) {
  node.apply(input::InputUp{Line::second, 2_id}, now);
  word(Line::second, FoldWordKind::deaf, 2_id);
  word(Line::second, FoldWordKind::hears, 2_id);
  node.apply(input::InputUp{Line::first, 0_id}, now);
  const Bytes packet = foreign_interrupt(0, 3, 2);
  node.receive(Line::first, {SliceKind::interrupt, {packet.data(), packet.size()}}, now);
  run();
  EXPECT_THAT(given(Line::first, SliceKind::interrupt), SizeIs(0));
  EXPECT_EQ(node.counters().dropped_no_output, 1u);
}

// At the end of an open chain another node's break is forgotten, whatever this node's input is (seed 322 of
// test/model).
TEST(KnownBreaks, OfOthersAreForgottenWhenAFoldHasClosedTheRing) {
  KnownBreak known(1_id);
  wire::Beacon beacon;
  beacon.break_known = true;
  beacon.break_before = 2_id;
  beacon.break_behind = 3_id;
  ASSERT_TRUE(known.heard(beacon, 3_id));
  known.ring_closed(true);
  EXPECT_FALSE(known.known());
  known.found(0_id);
  known.ring_closed(true);
  EXPECT_TRUE(known.is_own());
}

}  // namespace
}  // namespace limb_ring::core
