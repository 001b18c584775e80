// Time-outs, retries, damaged, late and unmatched returns.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::IsEmpty;
using testing::SizeIs;
using wire::SliceKind;

struct Retry : testing::Test {
  SoloNode solo;
  void SetUp() override { solo.join(); }
  void send(NodeId to = 2_id) {
    const Bytes data = text("payload");
    solo.node().send(send_of(1, ++token_, to, data), solo.now());
    solo.run();
  }
  Bytes sent() {
    const auto out = solo.line();
    EXPECT_THAT(out, SizeIs(1));
    return out.empty() ? Bytes(13) : out[0].bytes;
  }
  wire::Code code(const Bytes& packet) { return wire::code_of(packet[0]); }
  void home(const Bytes& packet, std::uint8_t fbc = 9) { solo.receive(SliceKind::whole, SoloNode::home(packet, fbc)); }

 private:
  std::uint32_t token_ = 0;
};

TEST_F(Retry, OfACancelledSendDoesNotLeaveThoughItWaitsForTheLineAlready) {
  send();
  solo.node().interrupt({1, 9, 2_id, wire::Factor{1}}, solo.now());
  solo.run();
  EXPECT_THAT(solo.line(), SizeIs(2));
  solo.node().set_output_ready(false);
  solo.run_for(100ms);  // both are overdue, and wait
  solo.node().cancel(1, solo.now());
  solo.node().set_output_ready(true);
  solo.run_for(1ms);
  EXPECT_THAT(solo.line(), IsEmpty());
  EXPECT_EQ(solo.counters().retries, 0u);
  EXPECT_EQ(solo.counters().ended_cancelled, 2u);
  send();
  EXPECT_EQ(code(sent()).attempt, 0) << "the next send goes on";
}

TEST_F(Retry, TimeOutSendsTheSameSequenceWithTheNextTryNumber) {
  send();
  const Bytes first = sent();
  for (unsigned attempt = 1; attempt <= 3; ++attempt) {
    solo.run_for(99ms);
    EXPECT_THAT(solo.line(), IsEmpty());
    solo.run_for(1ms);
    const Bytes again = sent();
    EXPECT_EQ(code(again).sequence, code(first).sequence);
    EXPECT_EQ(code(again).attempt, attempt);
  }
  solo.run_for(100ms);
  EXPECT_THAT(solo.line(), IsEmpty());
  EXPECT_THAT(solo.ends(), ElementsAre(Field(&SendEnded::outcome, Outcome::lost)));
  EXPECT_EQ(solo.ends()[0].tries, 4u);
  EXPECT_EQ(solo.counters().timeouts, 4u);
  EXPECT_EQ(solo.counters().retries, 3u);
}

TEST_F(Retry, InterruptsAreTriedAgainAsDataIs) {
  solo.node().interrupt({1, 1, 2_id, wire::Factor{1}}, solo.now());
  solo.run_for(350ms);
  const auto out = solo.line();
  ASSERT_THAT(out, SizeIs(4));
  for (unsigned attempt = 0; attempt < 4; ++attempt) EXPECT_EQ(code(out[attempt].bytes).attempt, attempt);
  EXPECT_EQ(solo.counters().retries, 3u);
  solo.run_for(100ms);
  EXPECT_THAT(solo.ends(), ElementsAre(Field(&SendEnded::outcome, Outcome::lost)));
}

TEST_F(Retry, TimeOutIsTwoWorstLapsIfThatIsLonger) {
  SoloNode slow(100us);
  const Duration two_laps = 2 * 4 * (100us * (524 + 12));
  ASSERT_GT(two_laps, slow.node().settings().send_timeout_least);
  slow.run_for(two_laps - Duration{1});
  EXPECT_EQ(slow.counters().retries, 0u);
  slow.run_for(Duration{1});
  EXPECT_EQ(slow.counters().retries, 1u);
}

TEST_F(Retry, DamagedReturnIsSentAgainAtOnce) {
  send();
  Bytes back = SoloNode::home(sent(), 9);
  back[6] ^= 1;
  solo.receive(SliceKind::whole, back);
  EXPECT_EQ(code(sent()).attempt, 1u);
  EXPECT_EQ(solo.counters().returns_damaged, 1u);
  EXPECT_EQ(solo.counters().crc_errors, 1u);
}

TEST_F(Retry, DamagedInterruptIsSentAgainAtOnce) {
  solo.node().interrupt({1, 1, 2_id, wire::Factor{1}}, solo.now());
  solo.run();
  Bytes back = SoloNode::home(sent(), 1);
  back[7] ^= 1;
  solo.receive(SliceKind::interrupt, back);
  EXPECT_EQ(code(sent()).attempt, 1u);
}

TEST_F(Retry, BrokenOffReturnIsSentAgainAtOnce) {
  send();
  solo.receive(SliceKind::start, head_of(SoloNode::home(sent(), 9)));
  solo.receive(SliceKind::abort, {});
  EXPECT_EQ(code(sent()).attempt, 1u);
}

TEST_F(Retry, ReturnOfAnEarlierTryCountsNoMore) {
  send();
  const Bytes first = sent();
  solo.run_for(100ms);
  const Bytes second = sent();
  home(first);
  EXPECT_THAT(solo.ends(), IsEmpty());
  EXPECT_EQ(solo.counters().returns_unmatched, 1u);
  home(second);
  EXPECT_THAT(solo.ends(), ElementsAre(Field(&SendEnded::outcome, Outcome::delivered)));
}

TEST_F(Retry, ReturnWhileItsRetryWaitsForTheLineCountsWithItsOwnRoundTrip) {
  send();
  const Bytes first = sent();
  solo.node().set_output_ready(false);
  solo.run_for(102ms);
  home(first);
  ASSERT_THAT(solo.ends(), ElementsAre(Field(&SendEnded::outcome, Outcome::delivered)));
  EXPECT_EQ(solo.ends()[0].round_trip, 102ms);
  EXPECT_EQ(solo.ends()[0].tries, 1u);
}

TEST_F(Retry, ThatNeverGetsOntoTheLineEndsLostInTime) {
  send();
  solo.line();
  solo.node().set_output_ready(false);
  const Settings& settings = solo.node().settings();
  solo.run_for(settings.send_timeout() + settings.queue_timeout - Duration{1});
  EXPECT_THAT(solo.ends(), IsEmpty());
  solo.run_for(Duration{1});
  EXPECT_THAT(solo.ends(), ElementsAre(Field(&SendEnded::outcome, Outcome::lost)));
}

/// Its receiver may start meanwhile, and hear this node later: then the tries must be over.
TEST(RetryInARingOfParts, DoesNotWaitForTheLineLongerThanTheTriesOfAPacketLast) {
  SoloNode solo{Duration{0}, [](Settings& s) { s.several_hosts = true; }};
  solo.join();
  const Bytes data = text("payload");
  solo.node().send(send_of(1, 1, 2_id, data), solo.now());
  solo.node().interrupt({1, 2, 2_id, wire::Factor{1}}, solo.now());
  solo.run();
  solo.line();
  solo.node().set_output_ready(false);
  solo.run_for(4 * solo.node().settings().send_timeout() - Duration{1});
  EXPECT_THAT(solo.ends(), IsEmpty());
  solo.run_for(Duration{1});
  const auto is_lost = Field(&SendEnded::outcome, Outcome::lost);
  EXPECT_THAT(solo.ends(), ElementsAre(is_lost, is_lost));
  solo.node().set_output_ready(true);
  solo.run_for(1ms);
  EXPECT_EQ(solo.counters().retries, 0u);
}

TEST_F(Retry, LateReturnAfterTheEndIsDiscardedAndCounted) {
  send();
  const Bytes packet = sent();
  home(packet);
  home(packet);
  EXPECT_THAT(solo.ends(), SizeIs(1));
  EXPECT_EQ(solo.counters().returns_unmatched, 1u);
  EXPECT_THAT(solo.line(), IsEmpty()) << "an own packet is never passed on";
}

/// A good CRC alone is not enough: every field must be what was sent.
TEST_F(Retry, ReturnThatDiffersInAnyFieldIsNotTheReturn) {
  send();
  const Bytes packet = sent();
  const std::size_t trailer = packet.size() - 8;
  for (std::size_t at : {std::size_t{0}, std::size_t{5}, trailer + 2, trailer + 3}) {
    Bytes other = packet;
    other[at] ^= 4;
    const std::size_t covered = other.size() - 4;
    wire::store_u32(other.data() + covered, wire::crc32({other.data(), covered}));
    home(other);
  }
  Bytes longer = Foreign{1, 2}.with_sequence(code(packet).sequence).with(text("payloads"));
  home(longer);
  EXPECT_THAT(solo.ends(), IsEmpty());
  EXPECT_EQ(solo.counters().returns_unmatched, 5u);
}

TEST_F(Retry, RefusalAfterARepeatIsNotSure) {
  send();
  Bytes back = SoloNode::home(sent(), 0);
  back[6] ^= 1;
  solo.receive(SliceKind::whole, back);
  for (int i = 0; i < 2000 && solo.ends().empty(); ++i) {
    solo.run_for(1ms);
    for (const auto& out : solo.line()) home(out.bytes, 0);
  }
  EXPECT_THAT(solo.ends(), ElementsAre(Field(&SendEnded::outcome, Outcome::lost)));
}

TEST_F(Retry, NobodyTookItAfterARepeatIsNotSure) {
  send(3_id);
  sent();
  solo.run_for(100ms);
  home(sent(), wire::kFbcUntaken);
  EXPECT_THAT(solo.ends(), ElementsAre(Field(&SendEnded::outcome, Outcome::lost)));
}

TEST_F(Retry, ALapAheadOfItsTimeOutNothingIsRepeated) {
  send();
  const Bytes packet = sent();
  solo.run_for(99ms);
  home(packet);
  solo.run_for(1s);
  EXPECT_EQ(solo.counters().timeouts, 0u);
  EXPECT_THAT(solo.line(), IsEmpty());
}

}  // namespace
}  // namespace limb_ring::core
