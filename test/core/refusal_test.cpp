// FBC, and what a receiver without a buffer does to a send.
#include "core/solo_node.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// One receive buffer per priority, and CPUs 1 to 3 read nothing.
struct Refusal : testing::Test {
  VirtualRing ring{with(quick(4), [](Settings& s) {
    s.receive_buffers = 1;
    s.refused_for = 20ms;
  })};
  void SetUp() override {
    ASSERT_TRUE(ring.join());
    for (NodeId id : {1_id, 2_id, 3_id}) ring.set_cpu_reads(id, false);
  }
  SendEnded send(NodeId from, NodeId to, const Bytes& data, std::uint8_t priority = 0) {
    return outcome_of(ring, from, ring.send(from, to, data, priority));
  }
};

TEST_F(Refusal, UnicastIsRefusedAfterItsDeadline) {
  EXPECT_EQ(send(0_id, 1_id, text("first")).outcome, Outcome::delivered);
  const Time asked = ring.now();
  const SendEnded end = send(0_id, 1_id, text("second"));
  EXPECT_EQ(end.outcome, Outcome::refused);
  EXPECT_GE(ring.now() - asked, 20ms);
  EXPECT_LE(ring.now() - asked, 21ms);
  EXPECT_GT(end.tries, 3u) << "each one a new packet";
  EXPECT_EQ(ring.counters(1_id).refused_no_buffer, end.tries);
  EXPECT_EQ(ring.counters(0_id).retries, 0u);
  ring.set_cpu_reads(1_id, true);
  ring.send(3_id, 1_id, text("third"));
  ring.run_for(5ms);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("first"), text("third")));
}

TEST_F(Refusal, UnicastGoesAgainUntilABufferIsFree) {
  send(0_id, 1_id, text("first"));
  const auto second = ring.send(0_id, 1_id, text("second"));
  ring.run_for(5ms);
  EXPECT_EQ(ring.ended(0_id, second), nullptr);
  ring.set_cpu_reads(1_id, true);
  ring.send(2_id, 1_id, text("other"), 3);  // wakes the reader
  EXPECT_EQ(outcome_of(ring, 0_id, second).outcome, Outcome::delivered);
  EXPECT_THAT(payloads(ring.log(1_id)), ElementsAre(text("first"), text("other"), text("second")));
}

TEST_F(Refusal, WaitDoublesUpToItsLimit) {
  send(0_id, 1_id, text("first"));
  std::vector<Time> sent;
  ring.tap(0_id, [&](const wire::Slice& slice, Time now, wire::SliceWriter& arriving) {
    sent.push_back(now);
    arriving.put(slice.kind, slice.bytes);
  });
  send(0_id, 1_id, text("second"));
  std::vector<Duration> waits;
  for (std::size_t i = 1; i < sent.size(); ++i) waits.push_back(sent[i] - sent[i - 1] - 4us);
  ASSERT_GE(waits.size(), 5u);
  EXPECT_THAT(std::vector<Duration>(waits.begin(), waits.begin() + 4), ElementsAre(1ms, 2ms, 4ms, 8ms));
}

TEST_F(Refusal, HoldsOnlyItsOwnPriorityBack) {
  send(0_id, 1_id, text("first"), 1);
  const auto refused = ring.send(0_id, 1_id, text("refused"), 1);
  const auto behind = ring.send(0_id, 2_id, text("behind"), 1);
  const auto urgent = ring.send(0_id, 2_id, text("urgent"), 0);
  const auto slow = ring.send(0_id, 2_id, text("slow"), 3);
  EXPECT_EQ(outcome_of(ring, 0_id, refused).outcome, Outcome::refused);
  EXPECT_EQ(outcome_of(ring, 0_id, behind).outcome, Outcome::delivered);
  EXPECT_THAT(ended_tokens(ring.log(0_id)), ElementsAre(1, urgent, slow, refused, behind));
}

TEST_F(Refusal, BroadcastIsNotSentAgain) {
  send(0_id, 2_id, text("full"));
  const SendEnded end = send(0_id, wire::kBroadcast, text("all"));
  EXPECT_EQ(end.outcome, Outcome::refused) << "FBC is the least any receiver wrote";
  EXPECT_EQ(end.tries, 1u);
  EXPECT_EQ(ring.node(1_id).received_waiting(), 1u);
  EXPECT_EQ(ring.node(2_id).received_waiting(), 1u);
  EXPECT_EQ(ring.node(3_id).received_waiting(), 1u);
}

TEST_F(Refusal, BuffersAreCountedPerPriority) {
  for (std::uint8_t priority = 0; priority < 4; ++priority)
    EXPECT_EQ(send(0_id, 1_id, text("one"), priority).outcome, Outcome::delivered);
  EXPECT_EQ(send(0_id, 1_id, text("two"), 2).outcome, Outcome::refused);
}

TEST_F(Refusal, AbsentCpuRefuses) {
  ring.set_cpu_present(3_id, false);
  EXPECT_EQ(send(0_id, 3_id, text("a")).outcome, Outcome::refused);
  EXPECT_GT(ring.counters(3_id).refused_cpu_absent, 0u);
  ring.set_cpu_present(3_id, true);
  EXPECT_EQ(send(0_id, 3_id, text("b")).outcome, Outcome::delivered);
}

TEST_F(Refusal, CpuOutcomeIsNeverDelivered) {
  ring.set_cpu_present(3_id, false);
  send(0_id, 3_id, text("a"));
  ring.set_cpu_reads(3_id, true);
  ring.run_for(10ms);
  EXPECT_THAT(ring.log(3_id).packets, IsEmpty());
}

TEST_F(Refusal, OverdueInTheQueueAfterOnlyRefusalsEndsRefused) {
  VirtualRing impatient(with(quick(4), [](Settings& s) {
    s.receive_buffers = 1;
    s.queue_timeout = 10ms;
  }));
  ASSERT_TRUE(impatient.join());
  impatient.set_cpu_reads(1_id, false);
  impatient.send(0_id, 1_id, text("first"));
  const auto second = impatient.send(0_id, 1_id, text("second"));
  EXPECT_EQ(outcome_of(impatient, 0_id, second).outcome, Outcome::refused);
}

/// Node 1 refuses a send of node 0, and another one of the same priority waits behind it.
struct BehindARefusal : testing::Test {
  VirtualRing ring{with(quick(4), [](Settings& s) {
    s.receive_buffers = 1;
    s.queue_timeout = 10ms;
  })};
  std::uint32_t refused = 0;
  void SetUp() override {
    ASSERT_TRUE(ring.join());
    ring.set_cpu_reads(1_id, false);
    outcome_of(ring, 0_id, ring.send(0_id, 1_id, text("first")));
    refused = ring.send(0_id, 1_id, text("refused"));
    ring.run_for(2ms);
  }
};

TEST_F(BehindARefusal, ARoundTripBeginsWhenThePacketLeaves) {
  const auto behind = ring.send(0_id, 2_id, text("behind"));
  EXPECT_EQ(outcome_of(ring, 0_id, refused).outcome, Outcome::refused);
  EXPECT_EQ(outcome_of(ring, 0_id, behind).round_trip, Duration{4us});
}

TEST_F(BehindARefusal, ARoundTripBeginsWhenThePacketLeavesAfterACancelToo) {
  const Bytes data = text("of another owner");
  ring.node(0_id).apply(input::Send{send_of(2, 77, 2_id, data)}, ring.now());
  ring.run_for(1ms);
  ring.cancel(0_id);
  EXPECT_EQ(outcome_of(ring, 0_id, refused).outcome, Outcome::cancelled);
  EXPECT_EQ(outcome_of(ring, 0_id, 77).round_trip, Duration{4us});
}

/// FBC as it leaves node 3, on its way home to node 0.
struct FreeBuffers : testing::Test {
  VirtualRing ring{with(quick(4), [](Settings& s) { s.receive_buffers = s.id == 1 ? 5 : s.id == 2 ? 3 : 400; })};
  std::uint8_t fbc = 0;
  void SetUp() override {
    ASSERT_TRUE(ring.join());
    for (NodeId id : {1_id, 2_id, 3_id}) ring.set_cpu_reads(id, false);
    ring.tap(3_id, [this](const wire::Slice& slice, Time, wire::SliceWriter& arriving) {
      fbc = wire::PacketFields{slice.bytes}.fbc();
      arriving.put(slice.kind, slice.bytes);
    });
  }
  std::uint8_t fbc_after(NodeId to, std::uint8_t priority = 0) {
    outcome_of(ring, 0_id, ring.send(0_id, to, text("a"), priority));
    return fbc;
  }
};

TEST_F(FreeBuffers, ReceiverWritesItsFreeBuffersBeforeTakingThisOne) {
  EXPECT_EQ(fbc_after(1_id), 5);
  EXPECT_EQ(fbc_after(1_id), 4);
  EXPECT_EQ(fbc_after(1_id, 2), 5) << "of that priority";
}

TEST_F(FreeBuffers, BroadcastCarriesTheMinimumOfAllReceivers) { EXPECT_EQ(fbc_after(wire::kBroadcast), 3); }
TEST_F(FreeBuffers, AtMost254IsWritten) { EXPECT_EQ(fbc_after(3_id), 254); }
TEST_F(FreeBuffers, NobodyWritesIfNobodyIsAddressed) { EXPECT_EQ(fbc_after(0_id), wire::kFbcUntaken); }

TEST(RefusalAlone, AtItsDeadlineIsTheEnd) {
  SoloNode solo;
  solo.join();
  const Bytes data = text("x");
  const auto refused = [&solo] { solo.receive(wire::SliceKind::whole, SoloNode::home(solo.line().back().bytes, 0)); };
  solo.line();
  solo.node().send(send_of(1, 1, 2_id, data), solo.now());
  solo.run();
  refused();
  const Time deadline = solo.now() + solo.node().settings().refused_for;
  while (solo.node().next_deadline(solo.now()) < deadline) {
    solo.run_for(solo.node().next_deadline(solo.now()) - solo.now());
    refused();
  }
  solo.run_for(deadline - solo.now());
  EXPECT_TRUE(solo.ends().empty());
  refused();
  EXPECT_THAT(solo.ends(), ElementsAre(testing::Field(&SendEnded::outcome, Outcome::refused)));
}

TEST(RefusalAlone, IsOfANodeWhoseCpuWasNeverThere) {
  Blocks node(SoloNode::settings({}, [](Settings&) {}));
  node.input_up(0_id, Time{});
  node.output_up(2_id, Time{});
  node.run(Time{});
  const wire::ByteView hello = wire::parse_slice(node.line().view()).slice.bytes;
  const Bytes home = SoloNode::home({hello.begin(), hello.end()}, wire::kFbcMax);
  node.receive(Line::first, {wire::SliceKind::whole, {home.data(), home.size()}}, Time{});
  ASSERT_EQ(node.membership().state(), NodeState::up);
  const Bytes packet = Foreign{0, 1}.with(text("x"));
  node.receive(Line::first, {wire::SliceKind::whole, {packet.data(), packet.size()}}, Time{});
  EXPECT_EQ(node.counters().refused_cpu_absent, 1u);
}

}  // namespace
}  // namespace limb_ring::core
