// Fold-back: a second, counter-rotating line closes the ring again around a break. (protocol.md section 8.7)
#include <map>

#include "core/copied_state.h"
#include "core/solo_node.h"

namespace limb_ring::core {
namespace {

constexpr unsigned kNodes = 8;

VirtualRingOptions folding(VirtualRingOptions options) {
  return with(std::move(options), [](Settings& s) {
    s.fold_back = true;
    s.beacon = 10ms;
    s.break_grace = s.fold_permission = 1ms;
    s.send_timeout_least = 200us;
  });
}

/// Every node sends 512 bytes, and again as soon as that has ended.
void keep_sending(VirtualRing& ring, std::map<Outcome, unsigned>& ends) {
  const auto send = [&ring](NodeId id) { ring.send(id, static_cast<NodeId>((id + 5) % kNodes), pattern(512)); };
  ring.on_event = [&ends, send](NodeId id, const Event& event) {
    const auto* end = std::get_if<SendEnded>(&event.what);
    if (!end || end->owner != sim::VirtualRing::kUser) return;
    ++ends[end->outcome];
    send(id);
  };
  for (NodeId id{0}; id < kNodes; ++id) send(id);
}

struct FoldBackTest : testing::Test {
  VirtualRing ring{folding(quick(kNodes))};
  void SetUp() override {
    ASSERT_TRUE(ring.join());
    ring.run_for(50ms);
  }
  const Membership& membership(NodeId id) { return ring.node(id).membership(); }
  void expect_all(NodeState state, unsigned size = kNodes) {
    for (NodeId id{0}; id < kNodes; ++id) {
      EXPECT_EQ(membership(id).state(), state) << int{id};
      EXPECT_EQ(membership(id).ring_size(), size) << int{id};
    }
  }
  /// Every node sends to every other one and all; each is confirmed.
  void expect_all_reach_all() {
    for (NodeId from{0}; from < kNodes; ++from) {
      for (NodeId to{0}; to < kNodes; ++to)
        EXPECT_EQ(outcome_of(ring, from, ring.send(from, to, text("x"))).outcome, Outcome::delivered)
            << int{from} << " to " << int{to};
      EXPECT_EQ(outcome_of(ring, from, ring.interrupt(from, wire::kBroadcast, 0)).outcome, Outcome::delivered);
    }
  }
  std::uint64_t all(std::uint64_t Counters::*counter) const {
    std::uint64_t sum = 0;
    for (NodeId id{0}; id < kNodes; ++id) sum += ring.counters(id).*counter;
    return sum;
  }
};

TEST_F(FoldBackTest, IsNotThereWhileTheRingIsWhole) {
  expect_all(NodeState::up);
  EXPECT_EQ(all(&Counters::folds), 0u);
  EXPECT_EQ(all(&Counters::fold_discarded), 0u);
}

/// Where the cable is cut between a node and the next.
struct AnyPlace : FoldBackTest, testing::WithParamInterface<unsigned> {
  NodeId before = static_cast<NodeId>(GetParam());
  NodeId behind = static_cast<NodeId>((GetParam() + 1) % kNodes);
};
INSTANTIATE_TEST_SUITE_P(FoldBack, AnyPlace, testing::Range(0u, kNodes));

TEST_P(AnyPlace, ACutCableLeavesAllReachingAll) {
  ring.cut_cable(before);
  ring.run_for(30ms);
  expect_all(NodeState::folded);
  EXPECT_EQ(ring.counters(before).folds, 1u);
  EXPECT_EQ(ring.counters(behind).folds, 1u);
  EXPECT_EQ(all(&Counters::folds), 2u);
  expect_all_reach_all();
}

TEST_P(AnyPlace, ABreakInOneDirectionIsReportedToTheNodeBeforeItOverTheSecondLine) {
  ring.cut(before);
  ring.run_for(30ms);
  expect_all(NodeState::folded);
  expect_all_reach_all();
}

TEST_P(AnyPlace, TheBrokenLineIsLocatedByAll) {
  ring.cut(before);
  ring.run_for(30ms);
  for (NodeId id{0}; id < kNodes; ++id) {
    if (id == behind) continue;
    const wire::Beacon& beacon = membership(id).peers()[behind].beacon;
    EXPECT_TRUE(beacon.break_known);
    EXPECT_EQ(beacon.break_before, before);
    EXPECT_EQ(beacon.input, wire::LinkState::folded);
    if (id != before) {
      EXPECT_EQ(membership(id).peers()[before].beacon.output, wire::LinkState::folded);
    }
  }
}

TEST_P(AnyPlace, HealsWithoutLosingAPacket) {
  ring.cut_cable(before);
  ring.run_for(30ms);
  const std::uint64_t timeouts = all(&Counters::timeouts);
  std::map<Outcome, unsigned> ends;
  keep_sending(ring, ends);
  ring.run_for(10ms);
  ring.heal_cable(before);
  ring.run_for(30ms);
  expect_all(NodeState::up);
  EXPECT_EQ(ends.size(), 1u) << "all ended delivered";
  EXPECT_EQ(all(&Counters::timeouts), timeouts);
  EXPECT_EQ(all(&Counters::fold_held_dropped), 0u);
  EXPECT_EQ(all(&Counters::insertion_buffer_full), 0u);
}

TEST_P(AnyPlace, HealsABreakInOneDirectionToo) {
  ring.cut(before);
  ring.run_for(30ms);
  ring.heal(before);
  ring.run_for(30ms);
  expect_all(NodeState::up);
  expect_all_reach_all();
  for (NodeId id{0}; id < kNodes; ++id) EXPECT_FALSE(membership(id).peers()[behind].beacon.break_known);
}

// The node before the break may still say that it has turned back: it is not asked about the line.
TEST_P(AnyPlace, TheNodeBehindTheBreakIsBelievedWhenItReportsTheMend) {
  ring.cut(before);
  ring.run_for(30ms);
  unsigned told = 0, believed = 0;
  ring.on_event = [&](NodeId id, const Event& event) {
    const auto* news = std::get_if<PeerChanged>(&event.what);
    if (!news || news->node != behind || membership(id).peers()[behind].beacon.break_known) return;
    ++told;
    if (!membership(id).broken_line()) ++believed;
  };
  ring.heal(before);
  ring.run_for(30ms);
  EXPECT_GE(told, kNodes - 1);
  EXPECT_EQ(believed, told);
}

// What is confirmed is neither lost nor doubled: the fixture's invariants check every packet.
TEST_F(FoldBackTest, ABreakInFullTrafficLosesNothingThatCanBeSentAgain) {
  std::map<Outcome, unsigned> ends;
  keep_sending(ring, ends);
  ring.run_for(5ms);
  ring.cut_cable(4_id);
  ring.run_for(50ms);
  expect_all(NodeState::folded);
  EXPECT_GT(ends[Outcome::delivered], 0u);
  EXPECT_EQ(ends.size(), 1u) << "all ended delivered";
}

TEST_F(FoldBackTest, ServiceIsBackWithinALapOfTheSecondLine) {
  const Time cut = ring.now();
  ring.cut_cable(2_id);
  const bool back = ring.run_until([&] { return ring.node(3_id).membership().state() == NodeState::folded; }, 1s);
  ASSERT_TRUE(back);
  // Node 2 knows at once; its word goes over seven lines of 1 us, and the controller behind is told.
  EXPECT_LE(ring.now() - cut, Duration{7us});
}

TEST_F(FoldBackTest, ASecondBreakLeavesTwoWorkingParts) {
  ring.cut_cable(1_id);  // 2 3 4 5 | 6 7 0 1
  ring.run_for(30ms);
  ring.cut_cable(5_id);
  ring.run_for(100ms);
  expect_all(NodeState::folded, 4);
  EXPECT_EQ(outcome_of(ring, 2_id, ring.send(2_id, 5_id, text("a"))).outcome, Outcome::delivered);
  EXPECT_EQ(outcome_of(ring, 5_id, ring.send(5_id, 2_id, text("a"))).outcome, Outcome::delivered);
  EXPECT_EQ(outcome_of(ring, 7_id, ring.send(7_id, 0_id, text("a"))).outcome, Outcome::delivered);
  EXPECT_EQ(outcome_of(ring, 7_id, ring.send(7_id, 3_id, text("a"))).outcome, Outcome::no_such_node);
}

// Own packets that come home to it change nothing: the fold is somewhere else in the ring.
TEST_F(FoldBackTest, ANodeThatGoesOnFromAStateIsStillFolded) {
  ring.cut_cable(4_id);
  ring.run_for(34ms);  // no beacon is under way
  expect_all(NodeState::folded);
  NetworkController node{ring.settings(0_id), ring.now()};
  read_state(bytes_of(ring.node(0_id)), node);
  const Bytes data = text("round");
  node.apply(input::Send{send_of(1, 1, 2_id, data)}, ring.now());
  node.apply(input::Run{}, ring.now());
  const wire::Slice sent = wire::parse_slice(node.output(Line::first).view()).slice;
  ASSERT_EQ(sent.kind, wire::SliceKind::whole);
  const Bytes home = SoloNode::home({sent.bytes.begin(), sent.bytes.end()}, 1, kNodes - 1);
  node.receive(Line::first, {wire::SliceKind::whole, {home.data(), home.size()}}, ring.now());
  EXPECT_EQ(node.counters().ended_delivered, ring.counters(0_id).ended_delivered + 1);
  EXPECT_EQ(node.membership().state(), NodeState::folded);
}

TEST_F(FoldBackTest, TwoPartsGrowTogetherAgain) {
  ring.cut_cable(1_id);
  ring.cut_cable(5_id);
  ring.run_for(100ms);
  std::array<std::uint64_t, kNodes> boots;
  for (NodeId id{0}; id < kNodes; ++id) boots[id] = membership(id).boot();
  ring.heal_cable(1_id);
  ring.run_for(100ms);
  expect_all(NodeState::folded);
  for (NodeId id{0}; id < kNodes; ++id) EXPECT_GT(membership(id).boot(), boots[id]) << "numbers are new: " << int{id};
  expect_all_reach_all();
  ring.heal_cable(5_id);
  ring.run_for(100ms);
  expect_all(NodeState::up);
  expect_all_reach_all();
}

TEST_F(FoldBackTest, NothingCirclesOnTheSecondLineOnceTheRingIsWhole) {
  for (int round = 0; round < 10; ++round) {
    ring.cut_cable(3_id);
    for (NodeId id{0}; id < kNodes; ++id) ring.send(id, wire::kBroadcast, pattern(100));
    ring.run_for(Duration{500ns} * round);
    ring.heal_cable(3_id);
    ring.run_for(Duration{700ns} * round);
  }
  ring.run_for(200ms);
  const std::uint64_t discarded = all(&Counters::fold_discarded);
  ring.run_for(200ms);
  EXPECT_EQ(all(&Counters::fold_discarded), discarded);
  expect_all(NodeState::up);
}

TEST_F(FoldBackTest, ADeadNodeIsLeftAsideNotFoldedAround) {
  ring.kill(4_id);
  ring.run_for(100ms);
  for (NodeId id{0}; id < kNodes; ++id) {
    if (id == 4) continue;
    EXPECT_EQ(membership(id).state(), NodeState::up) << int{id};
    EXPECT_EQ(membership(id).ring_size(), kNodes - 1) << int{id};
  }
}

TEST_F(FoldBackTest, ABypassIsReportedByTheNodesOnBothSidesOfIt) {
  ring.kill(4_id);
  ring.run_for(30ms);
  EXPECT_EQ(membership(6_id).peers()[5_id].beacon.input_from, 3);
  EXPECT_EQ(membership(6_id).peers()[3_id].beacon.output_to, 5);
}

// The node behind the break, the only one that is believed, is gone: it can no longer say that the line is mended.
TEST_F(FoldBackTest, ABreakIsForgottenThoughTheNodeBehindItHasDied) {
  ring.cut(3_id);
  ring.run_for(30ms);
  ASSERT_TRUE(membership(1_id).broken_line());
  ring.kill(4_id);
  ring.heal(3_id);
  ring.run_for(100ms);
  for (const NodeId id : {0_id, 1_id, 2_id, 3_id, 5_id, 6_id, 7_id}) {
    EXPECT_EQ(membership(id).state(), NodeState::up) << int{id};
    EXPECT_FALSE(membership(id).broken_line()) << int{id};
  }
}

// Its neighbours fold until they have bypassed it, and again when it is back; others' packets are only sent again.
TEST_F(FoldBackTest, ANodeThatDiesAndReturnsCostsOthersNothing) {
  std::map<Outcome, unsigned> ends;
  keep_sending(ring, ends);
  unsigned lost_by_others = 0;
  ring.on_event = [&, before = ring.on_event](NodeId id, const Event& event) {
    const auto* end = std::get_if<SendEnded>(&event.what);
    if (end && end->owner == sim::VirtualRing::kUser && end->outcome == Outcome::lost && id != 4 && id != 7)
      ++lost_by_others;
    before(id, event);
  };
  for (int times = 0; times < 10; ++times) {
    ring.run_for(3ms);
    ring.kill(4_id);
    ring.run_for(3ms);
    ring.start(4_id);
  }
  EXPECT_GT(ends[Outcome::delivered], 1000u);
  EXPECT_GT(ends[Outcome::no_such_node], 0u) << "node 7 sends to node 4";
  EXPECT_EQ(lost_by_others, 0u);
}

TEST_F(FoldBackTest, ANodeStartedBehindABreakJoins) {
  ring.kill(4_id);
  ring.run_for(10ms);
  ring.cut_cable(3_id);
  ring.run_for(100ms);
  ring.start(4_id);
  ring.run_for(100ms);
  expect_all(NodeState::folded);
  expect_all_reach_all();
}

// A line that is gone for less than a `begin` takes to come round: the node behind says `hears` once, and is done.
TEST_F(FoldBackTest, AHearsWordThatIsLostIsSentAgain) {
  bool lost = false;
  const auto lose_one = [&lost](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
    const auto word = wire::fold_word(slice);
    if (word && word->kind == wire::FoldWordKind::hears && !lost) return void(lost = true);
    arriving.put(slice.kind, slice.bytes);
  };
  ring.tap(4_id, lose_one, core::Line::second);
  ring.cut(3_id);
  ring.run_for(1us);
  ring.heal(3_id);
  ring.run_for(300ms);
  EXPECT_TRUE(lost);
  expect_all(NodeState::up);
  expect_all_reach_all();
}

// If nobody strips, what nobody understands would go on and on.
TEST_F(FoldBackTest, ADamagedWordIsNotRepeated) {
  ring.cut(3_id);
  ring.run_for(30ms);
  expect_all(NodeState::folded);
  unsigned damaged = 0, repeated = 0;
  const auto damage = [&damaged](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
    std::vector<std::uint8_t> bytes(slice.bytes.begin(), slice.bytes.end());
    if (slice.kind == wire::SliceKind::fold) bytes[1] ^= 4, ++damaged;
    arriving.put(slice.kind, {bytes.data(), bytes.size()});
  };
  const auto count = [&repeated](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
    if (slice.kind == wire::SliceKind::fold && !wire::fold_word(slice)) ++repeated;
    arriving.put(slice.kind, slice.bytes);
  };
  const auto discarded = ring.counters(1_id).fold_discarded;
  ring.tap(2_id, damage, core::Line::second);
  ring.tap(1_id, count, core::Line::second);
  ring.run_for(30ms);
  EXPECT_GE(damaged, 2u);
  EXPECT_EQ(repeated, 0u);
  EXPECT_EQ(ring.counters(1_id).fold_discarded, discarded + damaged);
  ring.tap(2_id, nullptr, core::Line::second);
  ring.run_for(100ms);
  expect_all(NodeState::folded);
  expect_all_reach_all();
}

// Both lines broken on one side, the first on another: nothing leads back, as without a second line.
TEST_F(FoldBackTest, WithTheSecondLineBrokenElsewhereTheRingIsAnOpenChain) {
  ring.cut(7_id, core::Line::second);
  ring.run_for(30ms);
  expect_all(NodeState::up);
  ring.cut(2_id);
  ring.run_for(100ms);
  EXPECT_EQ(membership(3_id).state(), NodeState::open_chain);
  ring.heal(7_id, core::Line::second);
  ring.run_for(100ms);
  expect_all(NodeState::folded);
  ring.heal(2_id);
  ring.run_for(100ms);
  expect_all(NodeState::up);
}

// One lap on the first line, one delay on the second: 7 relays back from node 2 to node 3.
TEST(FoldBackTiming, APacketGoesRoundWithTheSecondLinesDelaysAdded) {
  VirtualRing ring{folding(gigabit(kNodes))};
  ASSERT_TRUE(ring.join());
  ring.run_for(20ms);
  ring.cut_cable(2_id);
  ring.run_for(25ms);
  const SendEnded end = outcome_of(ring, 0_id, ring.send(0_id, 1_id, pattern(512)));
  EXPECT_EQ(end.outcome, Outcome::delivered);
  // T = 524 * 8 ns; seven lines of the first ring, seven of the second, one delay d each.
  EXPECT_EQ(end.round_trip, Duration{524 * 8ns} + 14 * Duration{512ns});
}

TEST(FoldBackTiming, HealsUnderFullLoadAtARateWithoutLoss) {
  VirtualRing ring{folding(gigabit(kNodes))};
  ASSERT_TRUE(ring.join());
  ring.cut_cable(2_id);
  ring.run_for(25ms);
  std::map<Outcome, unsigned> ends;
  keep_sending(ring, ends);
  ring.run_for(5ms);
  std::uint64_t before = 0, after = 0;
  for (NodeId id{0}; id < kNodes; ++id) before += ring.counters(id).timeouts;
  ring.heal_cable(2_id);
  ring.run_for(5ms);
  for (NodeId id{0}; id < kNodes; ++id) after += ring.counters(id).timeouts;
  EXPECT_EQ(after, before);
  EXPECT_EQ(ends.size(), 1u);
  EXPECT_EQ(ring.node(3_id).membership().state(), NodeState::up);
}

}  // namespace
}  // namespace limb_ring::core
