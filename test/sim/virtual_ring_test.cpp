// When the CPUs of a virtual ring get what is for them.
#include "sim/virtual_ring.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "support/node_literal.h"

namespace limb_ring::sim {
namespace {

using namespace std::chrono_literals;

VirtualRingOptions gigabit(unsigned nodes) {
  VirtualRingOptions options;
  options.nodes = nodes;
  options.byte_time = 8ns;
  return options;
}

TEST(VirtualRing, ACpuThatReadsAgainTakesWhatHasWaitedAtOnce) {
  VirtualRing ring(gigabit(3));
  ASSERT_TRUE(ring.join());
  ring.set_cpu_reads(1_id, false);
  ring.send(0_id, 1_id, {1, 2, 3});
  ring.run_for(1ms);
  ASSERT_TRUE(ring.log(1_id).packets.empty());
  ring.set_cpu_reads(1_id, true);
  ring.run_until(ring.now());
  EXPECT_EQ(ring.log(1_id).packets.size(), 1u);
}

TEST(VirtualRing, StopsJoiningWhenItIsAskedToStop) {
  VirtualRing ring(gigabit(3));
  ring.tap(1_id, [](const wire::Slice&, core::Time, wire::SliceWriter&) {});  // nothing comes round
  unsigned asked = 0;
  EXPECT_FALSE(ring.join([&] { return ++asked == 5; }));
  EXPECT_EQ(asked, 5u);
  EXPECT_LE(ring.now(), core::Time{5ms});
}

// Its packets tell one life from the next by the boot number's two low bits (docs/protocol.md, 4.8).
TEST(VirtualRing, ANodeThatStartsAgainHasAnotherIncarnation) {
  VirtualRing ring(gigabit(3));
  ASSERT_TRUE(ring.join());
  for (int life = 0; life < 5; ++life) {
    const std::uint64_t former = ring.node(1_id).membership().boot();
    ring.kill(1_id);
    ring.run_for(1ms);
    ring.start(1_id);
    const std::uint64_t boot = ring.node(1_id).membership().boot();
    EXPECT_GT(boot, former);
    EXPECT_NE(boot & 3, former & 3) << boot << " after " << former;
    ring.run_for(100ms);
  }
}

std::vector<unsigned> ring_sizes(VirtualRing& ring) {
  std::vector<unsigned> sizes;
  for (const NodeId id : ring.order()) sizes.push_back(ring.node(id).membership().ring_size());
  return sizes;
}

// ---- clocks that are not right ------------------------------------------------------------------

// A boot number comes from the wall clock; where that was set back, the next after the last one
// (docs/protocol.md, 4.8).
TEST(VirtualRing, ANodeWhoseWallClockIsSetBackBeginsItsNextIncarnationAllTheSame) {
  VirtualRing ring(gigabit(3));
  ASSERT_TRUE(ring.join());
  const auto boot = [&] { return ring.controller(1_id).membership().boot(); };
  const auto boots_further = [&](std::chrono::nanoseconds step) {
    const std::uint64_t former = boot();
    ring.step_wall_clock(1_id, step);
    ring.kill(1_id);
    ring.start(1_id);
    const std::uint64_t further = boot() - former;
    ring.run_for(10ms);
    return further;
  };
  // A node that begins counts once more while its lines come up.
  EXPECT_THAT(boots_further(-1h), testing::AllOf(testing::Ge(1u), testing::Le(2u)));
  EXPECT_THAT(boots_further(0h), testing::AllOf(testing::Ge(1u), testing::Le(2u)));
  EXPECT_GT(boots_further(2h), 3'600'000'000'000u);
  EXPECT_THAT(boots_further(-1h), testing::AllOf(testing::Ge(1u), testing::Le(2u)));
}

TEST(VirtualRing, TheClockOfASuspendedNodeStandsUntilItGoesOnAndThatOfAFrozenOneDoesNot) {
  VirtualRing ring(gigabit(4));
  ASSERT_TRUE(ring.join());
  const core::Time stood = ring.time_of(1_id);
  ring.freeze(1_id, /*clock_stands=*/true);
  ring.freeze(2_id);
  ring.run_for(3s);
  EXPECT_EQ(ring.time_of(1_id), stood);
  EXPECT_EQ(ring.time_of(2_id), ring.now());
  ring.thaw(1_id);
  ring.thaw(2_id);
  ring.run_for(2s);
  EXPECT_EQ(ring.time_of(1_id), stood + 2s);
  EXPECT_EQ(ring_sizes(ring), (std::vector<unsigned>{4, 4, 4, 4}));
  EXPECT_EQ(ring.in_ring(1_id, stood - 1us), ring.now() - 5s - 1us) << "before it stood";
}

TEST(VirtualRing, AMonotonicClockThatSkipsMakesWhatIsDueMeanwhileDueAtOnce) {
  VirtualRing ring(gigabit(3));
  ASSERT_TRUE(ring.join());
  ring.run_for(10ms);
  ring.tap(0_id, [](const wire::Slice&, core::Time, wire::SliceWriter&) {});  // its packet is lost
  const std::uint32_t token = ring.send(0_id, 1_id, {1, 2, 3});
  ring.run_for(1ms);
  ASSERT_EQ(ring.counters(0_id).timeouts, 0u);
  ring.skip_time(0_id, ring.settings(0_id).send_timeout());
  ring.tap(0_id, {});
  ring.run_for(1ms);
  EXPECT_EQ(ring.counters(0_id).timeouts, 1u);
  const core::SendEnded* end = ring.ended(0_id, token);
  ASSERT_NE(end, nullptr);
  EXPECT_EQ(end->outcome, core::Outcome::delivered);
  EXPECT_LT(end->round_trip, 1ms) << "by the ring's clock";
}

// ---- lines that are gone ------------------------------------------------------------------------

VirtualRingOptions noticing(unsigned nodes, Duration late) {
  VirtualRingOptions options = gigabit(nodes);
  options.noticing = [late] { return late; };
  options.adjust = [](core::Settings& settings) {
    settings.several_hosts = true;
    settings.send_timeout_least = 100us;
    settings.beacon = 1ms;
  };
  return options;
}

TEST(VirtualRing, AnEndOfALineThatIsGoneNoticesThatInItsTime) {
  VirtualRing ring(noticing(3, 300us));
  ASSERT_TRUE(ring.join());
  ring.cut(0_id);
  ring.run_for(299us);
  EXPECT_FALSE(ring.successor(0_id)) << "what it sends is lost at once";
  EXPECT_TRUE(ring.has_output(0_id)) << "and it does not know that";
  ring.run_for(1us);
  EXPECT_FALSE(ring.has_output(0_id));
}

TEST(VirtualRing, ALineThatIsBackBeforeItsEndsNoticeWasNeverGoneForThem) {
  VirtualRing ring(noticing(3, 300us));
  ASSERT_TRUE(ring.join());
  ring.run_for(10ms);
  const auto states = [&] {
    const auto& events = ring.log(1_id).events;
    const auto is_state = [](const core::Event& e) { return std::holds_alternative<core::StateChanged>(e.what); };
    return std::count_if(events.begin(), events.end(), is_state);
  };
  const auto before = states();
  ring.cut(0_id);
  ring.run_for(200us);
  ring.heal(0_id);
  ring.run_for(10ms);
  EXPECT_EQ(states(), before);
  EXPECT_EQ(ring_sizes(ring), (std::vector<unsigned>{3, 3, 3}));
}

// Node 0 leads to it until it has connected to node 1, which is there again.
TEST(VirtualRing, NoLineLeadsToTheNextLifeOfANodeThatHasGone) {
  VirtualRingOptions options = gigabit(4);
  options.connecting = [] { return Duration{50us}; };
  VirtualRing ring(options);
  ring.run_for(1ms);
  ring.kill(1_id);
  ring.run_for(1ms);
  ASSERT_EQ(ring.successor(0_id), 2_id);
  ring.start(1_id);
  ring.kill(2_id);
  ring.start(2_id);
  EXPECT_EQ(ring.successor(0_id), std::nullopt);
  ring.run_for(1ms);
  EXPECT_EQ(ring.successor(0_id), 1_id);
  EXPECT_EQ(ring.successor(1_id), 2_id);
}

TEST(VirtualRing, HostsThatLoseEachOtherEachCloseARingAndThenOneAgain) {
  VirtualRing ring(noticing(5, 300us));
  ASSERT_TRUE(ring.join());
  ring.part({1_id, 2_id});
  ring.run_for(50ms);
  EXPECT_EQ(ring_sizes(ring), (std::vector<unsigned>{3, 2, 2, 3, 3}));
  ring.regroup();
  ring.run_for(50ms);
  EXPECT_EQ(ring_sizes(ring), (std::vector<unsigned>{5, 5, 5, 5, 5}));
}

// Also if another packet's slice comes in just then.
TEST(VirtualRing, ACpuTakesEachPacketInTheInstantItIsIn) {
  VirtualRing ring(gigabit(8));
  ASSERT_TRUE(ring.join());
  unsigned taken = 0, late = 0;
  ring.on_packet = [&](NodeId, const core::ReceivedPacket& packet) {
    ++taken;
    if (ring.now() != packet.at) ++late;
  };
  ring.on_event = [&](NodeId id, const core::Event& event) {
    if (!std::holds_alternative<core::SendEnded>(event.what)) return;
    ring.send(id, wire::NodeId{wire::kBroadcast}, std::vector<std::uint8_t>(4 + id % 4u * 4u));
  };
  for (const NodeId id : ring.order()) ring.send(id, 1_id, {id});
  ring.run_for(20ms);
  EXPECT_GT(taken, 1000u);
  EXPECT_EQ(late, 0u);
}

TEST(VirtualRing, ANodeWithAFastClockKeepsShorterTimes) {
  core::Settings right;
  core::Settings fast = right;
  let_drift(fast, 100'000);
  EXPECT_EQ(fast.beacon, right.beacon * 10 / 11);
  EXPECT_EQ(fast.send_timeout(), right.send_timeout() * 10 / 11);
  EXPECT_EQ(fast.relay_delay, right.relay_delay) << "lines have no clock";
}

}  // namespace
}  // namespace limb_ring::sim
