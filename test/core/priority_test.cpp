// Priorities on both sides, queues and their limits.
#include "core/solo_node.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;

struct Priority : testing::Test {
  VirtualRing ring{with(quick(4), [](Settings& s) { s.send_queue = 3; })};
  void SetUp() override { ASSERT_TRUE(ring.join()); }
};

TEST_F(Priority, HigherOnesAreSentFirstAndOrderIsKeptWithinOne) {
  const auto first = ring.send(0_id, 1_id, text("on its way"), 3);
  ring.run_for(1us);
  const auto low = ring.send(0_id, 1_id, text("low"), 3);
  const auto middle = ring.send(0_id, 1_id, text("middle"), 1);
  const auto high = ring.send(0_id, 1_id, text("high"), 0);
  const auto high_too = ring.send(0_id, 1_id, text("high too"), 0);
  ring.run_for(1ms);
  EXPECT_THAT(ended_tokens(ring.log(0_id)), ElementsAre(first, high, high_too, middle, low));
}

TEST_F(Priority, CpuReadsHigherOnesFirst) {
  ring.set_cpu_reads(1_id, false);
  for (std::uint8_t priority : {2, 3, 0, 2, 1}) {
    const Bytes data(1, static_cast<std::uint8_t>(priority));
    outcome_of(ring, 0_id, ring.send(0_id, 1_id, data, priority));
  }
  ring.set_cpu_reads(1_id, true);
  ring.send(0_id, 1_id, Bytes(1, 3), 3);
  ring.run_for(1ms);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(Bytes{0}, Bytes{1}, Bytes{2}, Bytes{2}, Bytes{3}, Bytes{3}));
}

TEST_F(Priority, FullQueueRejectsItsOwnPriorityOnly) {
  for (int i = 0; i < 3; ++i) ring.send(0_id, 1_id, Bytes(1), 2);
  const auto fourth = ring.send(0_id, 1_id, Bytes(1), 2);
  const auto other = ring.send(0_id, 1_id, Bytes(1), 1);
  EXPECT_EQ(outcome_of(ring, 0_id, fourth).reject, Reject::queue_full);
  EXPECT_EQ(outcome_of(ring, 0_id, other).outcome, Outcome::delivered);
}

TEST_F(Priority, InterruptQueueIsBoundedToo) {
  for (int i = 0; i < 3; ++i) ring.interrupt(0_id, 1_id, 1);
  EXPECT_EQ(outcome_of(ring, 0_id, ring.interrupt(0_id, 1_id, 1)).reject, Reject::queue_full);
  ring.run_for(1ms);
  EXPECT_EQ(pins(ring.log(1_id)).size(), 3u);
}

TEST_F(Priority, OneDataPacketAndOneInterruptAreOutstanding) {
  std::uint64_t data = 0, interrupts = 0, most = 0;
  ring.tap(0_id, [&](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
    ++(is_interrupt(slice) ? interrupts : data);
    most = std::max(
        {most, data - ring.counters(0_id).returned_data, interrupts - ring.counters(0_id).returned_interrupts});
    arriving.put(slice.kind, slice.bytes);
  });
  data = ring.counters(0_id).returned_data;
  for (int i = 0; i < 3; ++i) ring.send(0_id, 1_id, Bytes(10));
  for (int i = 0; i < 3; ++i) ring.interrupt(0_id, 2_id, 2);
  ring.run_for(3us);
  EXPECT_EQ(ring.counters(0_id).sent_data - ring.counters(0_id).returned_data, 1u);
  EXPECT_EQ(ring.counters(0_id).sent_interrupts - ring.counters(0_id).returned_interrupts, 1u);
  ring.run_for(1ms);
  EXPECT_EQ(most, 1u);
  EXPECT_EQ(pins(ring.log(2_id)).size(), 3u);
  EXPECT_EQ(ring.log(1_id).packets.size(), 3u);
}

TEST_F(Priority, InterruptOvertakesDataStillQueued) {
  const auto first = ring.send(0_id, 2_id, text("first"));
  const auto second = ring.send(0_id, 2_id, text("second"));
  const auto interrupt = ring.interrupt(0_id, 2_id, 1);
  ring.run_for(1ms);
  EXPECT_THAT(ended_tokens(ring.log(0_id)), ElementsAre(interrupt, first, second));
}

// A continuous stream from upstream, and own packets beside it: the tie is the node's own.
TEST(Fairness, OwnPacketsAreNotStarvedByAStreamFromUpstream) {
  VirtualRing ring(gigabit(4));
  ASSERT_TRUE(ring.join());
  ring.on_event = [&](NodeId id, const Event& event) {
    if (std::holds_alternative<SendEnded>(event.what) && id != 2) ring.send(id, 3_id, Bytes(512));
  };
  for (NodeId id : {0_id, 1_id, 3_id}) ring.send(id, 3_id, Bytes(512));
  ring.run_for(100us);
  const Duration bound = 4 * (8ns * 524 + 512ns);
  for (int i = 0; i < 50; ++i) {
    const Time asked = ring.now();
    outcome_of(ring, 2_id, ring.send(2_id, 3_id, Bytes(512)));
    EXPECT_LE(ring.now() - asked, bound + 8ns * 524) << "worst case, from the request on";
  }
}

/// Own packets and one from upstream compete for the line.
struct OwnAndForeign : testing::Test {
  SoloNode solo;
  const Bytes data = text("own");
  void SetUp() override {
    solo.join();
    solo.line();
  }
  void send(Owner owner) { solo.node().send(send_of(owner, ++token_, 2_id, data), solo.now()); }
  void foreign_comes() { solo.receive(wire::SliceKind::whole, Foreign{0, 2}.with(text("foreign"))); }
  /// Who has sent what has gone out, in order.
  std::vector<unsigned> sources() {
    std::vector<unsigned> all;
    for (const SoloNode::Out& slice : solo.line()) all.push_back(slice.bytes[wire::field::kSource]);
    return all;
  }

 private:
  std::uint32_t token_ = 0;
};

TEST_F(OwnAndForeign, WhatANodeIsAskedToSendGoesBeforeWhatComesInThen) {
  send(1);
  foreign_comes();
  EXPECT_THAT(sources(), ElementsAre(1, 0));
}

// Behind a send that is given up, the next one waits only from then on.
TEST_F(OwnAndForeign, WhatMovesUpInItsQueueGoesBehindWhatHasComeInBefore) {
  solo.node().set_output_ready(false);
  send(1);
  send(2);
  solo.run_for(1us);
  foreign_comes();
  solo.run_for(1us);
  solo.node().cancel(1, solo.now());
  solo.node().set_output_ready(true);
  solo.run();
  EXPECT_THAT(sources(), ElementsAre(0, 1));
}

TEST_F(OwnAndForeign, WhatMovesUpBehindAnOverdueSendGoesBehindItToo) {
  solo.node().set_output_ready(false);
  send(1);
  solo.run_for(1us);
  send(1);
  solo.run_for(1us);
  foreign_comes();
  solo.run_for(solo.node().settings().queue_timeout - 2us);
  ASSERT_EQ(solo.ends().size(), 1u);
  solo.node().set_output_ready(true);
  solo.run();
  EXPECT_THAT(sources(), ElementsAre(0, 1));
}

}  // namespace
}  // namespace limb_ring::core
