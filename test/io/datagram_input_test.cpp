#include "io/datagram_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/hand_made_datagram.h"
#include "io/recording_handler.h"

namespace limb_ring::link {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Node 1's input, with this test as node 0 handing it datagrams, and a clock that only the test moves on.
struct DatagramInputFromHand : testing::Test, InputLine {
  static constexpr std::uint64_t kRing = 42;
  static constexpr Timing kTiming{milliseconds(20), milliseconds(60)};

  RecordingInput heard;
  InputReport report;
  Upstream upstream;
  Time now{};
  std::vector<LinkHeader> answers;
  DatagramInput input{settings(),
                      *this,
                      heard,
                      report,
                      upstream,
                      [this](wire::ByteView datagram, const UdpAddress&) {
                        answers.push_back(parse_header(datagram).value()); }};
  std::uint64_t session = 0;

  void SetUp() override {
    session = ask_for_session(7);
    datagram(1, {});
    ASSERT_EQ(input.from(), 0);
  }
  static InputSettings settings() {
    InputSettings settings;
    settings.self = {kRing, 1};
    settings.order = {0, 1, 2};
    settings.timing = kTiming;
    return settings;
  }
  void close() override { input.close(); }
  std::optional<std::uint8_t> from() const override { return input.from(); }
  void replace(std::uint8_t by) override { input.replace(by); }

  LinkHeader header(LinkHeaderType type, std::uint64_t number, std::uint8_t sender = 0) {
    return header_of(kRing, type, number, sender);
  }
  void send(const LinkHeader& header, wire::ByteView slices = {}) {
    const auto bytes = datagram_of(header, slices);
    input.take({bytes.data(), bytes.size()}, {}, now);
  }
  /// A datagram of the session with one slice holding `value`, or an idle one.
  void datagram(std::uint32_t sequence, std::optional<std::uint8_t> value) {
    wire::SliceWriter writer;
    const std::vector<std::uint8_t> bytes(20, value.value_or(0));
    writer.put(value ? wire::SliceKind::whole : wire::SliceKind::idle, {bytes.data(), value ? bytes.size() : 0});
    LinkHeader h = header(LinkHeaderType::slices, session);
    h.sequence = sequence;
    send(h, writer.view());
  }
  std::uint64_t ask_for_session(std::uint32_t nonce, std::uint8_t sender = 0) {
    send(header(LinkHeaderType::connect, std::uint64_t{nonce} << 32, sender));
    return answers.back().type == LinkHeaderType::accept ? answers.back().session : 0;
  }
  void tick() {
    now += kTiming.idle;
    if (input.tick(now)) input.lose_if_silent();
  }
  std::vector<std::uint8_t> values() {
    std::vector<std::uint8_t> all;
    for (const auto& slice : heard.slices) all.push_back(slice.front());
    return all;
  }
};

TEST_F(DatagramInputFromHand, GivesASessionANumberOfItsOwnWhateverTheAskersIs) {
  const std::uint64_t given = ask_for_session(0);
  EXPECT_EQ(session_nonce(given), 0u);
  EXPECT_NE(given, 0u) << "anybody could guess it, and on a keyed line it has no keys";
}

TEST_F(DatagramInputFromHand, HandsADoubledDatagramOnOnce) {
  for (const std::uint32_t i : {2u, 2u, 3u, 3u, 2u}) datagram(i, static_cast<std::uint8_t>(i));
  EXPECT_THAT(values(), ElementsAre(2, 3));
  EXPECT_EQ(report.counters.datagrams, 7u);
  EXPECT_EQ(report.counters.datagrams_duplicate, 3u);
  EXPECT_EQ(report.counters.datagrams_lost, 0u);
}

TEST_F(DatagramInputFromHand, SaysWhereDatagramsAreMissing) {
  datagram(2, 2);
  datagram(6, 6);
  input.end_batch();
  EXPECT_THAT(heard.log, ElementsAre("up 0", "slice", "gap", "slice", "batch end"));
  EXPECT_EQ(report.counters.datagrams_lost, 3u);
}

TEST_F(DatagramInputFromHand, DiscardsAnOvertakenDatagram) {
  for (const std::uint32_t i : {3u, 2u, 4u}) datagram(i, static_cast<std::uint8_t>(i));
  EXPECT_THAT(values(), ElementsAre(3, 4));
  EXPECT_EQ(report.counters.datagrams_lost, 1u);
  EXPECT_EQ(report.counters.datagrams_duplicate, 1u);
}

TEST_F(DatagramInputFromHand, DiscardsDatagramsOfASessionItDoesNotHaveAndSaysSoOnceATick) {
  answers.clear();
  session += 1;
  datagram(2, 2);
  datagram(3, 3);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers.front().refusal, Refusal::unknown_session);
  EXPECT_EQ(report.counters.datagrams_stale, 2u);
  EXPECT_THAT(heard.slices, IsEmpty());
  tick();
  answers.clear();
  datagram(4, 4);
  EXPECT_EQ(answers.size(), 1u);
}

TEST_F(DatagramInputFromHand, StartsAfreshInANewSessionOnly) {
  datagram(2, 2);
  const std::uint64_t old = session;
  session = ask_for_session(8);
  EXPECT_NE(session, old);
  datagram(1, 10);
  EXPECT_EQ(report.counters.replaced, 1u);
  session = old;
  datagram(3, 3);
  EXPECT_EQ(report.counters.datagrams_stale, 1u);
  EXPECT_THAT(values(), ElementsAre(2, 10));
}

TEST_F(DatagramInputFromHand, IsNotMovedByAnOldConnectThatComesLate) {
  ask_for_session(6);  // answered with an offer, which nobody takes up
  datagram(2, 2);
  EXPECT_THAT(heard.log, ElementsAre("up 0", "slice"));
  EXPECT_EQ(report.counters.connects, 1u);
}

TEST_F(DatagramInputFromHand, GivesADoubledConnectTheSameSession) {
  EXPECT_EQ(ask_for_session(7), session);
  const std::uint64_t offer = ask_for_session(9);
  EXPECT_EQ(ask_for_session(9), offer);
}

TEST_F(DatagramInputFromHand, DropsAnOfferThatNobodyTakesUp) {
  const std::uint64_t offer = ask_for_session(9);
  const Time end = now + kTiming.handshake();
  while (now <= end) tick();
  session = offer;
  datagram(1, 1);
  EXPECT_EQ(report.counters.datagrams_stale, 1u);
  EXPECT_EQ(report.counters.connects, 1u);
}

TEST_F(DatagramInputFromHand, RefusesANodeThatIsFartherAway) {
  EXPECT_EQ(ask_for_session(5, 2), 0u);
  EXPECT_EQ(answers.back().refusal, Refusal::busy);
  EXPECT_EQ(report.counters.refused, 1u);
}

TEST_F(DatagramInputFromHand, TellsANodeThatANearerOneTookItsPlace) {
  while (input.from()) tick();
  const std::uint64_t farther = ask_for_session(5, 2);
  session = ask_for_session(8);
  datagram(1, {});
  ASSERT_EQ(input.from(), 0);
  answers.clear();
  LinkHeader slices = header(LinkHeaderType::slices, farther, 2);
  slices.sequence = 1;
  send(slices);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers.front().refusal, Refusal::busy);
  EXPECT_EQ(report.counters.refused, 1u);
  EXPECT_EQ(report.counters.datagrams_stale, 0u);
}

TEST_F(DatagramInputFromHand, AnswersAnotherVersionOnceATick) {
  answers.clear();
  LinkHeader other = header(LinkHeaderType::connect, 1);
  other.version = kLinkVersion + 1;
  send(other);
  send(other);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers.front().refusal, Refusal::wrong_version);
}

TEST_F(DatagramInputFromHand, TurnsAGarbledDatagramIntoAGap) {
  LinkHeader h = header(LinkHeaderType::slices, session);
  h.sequence = 2;
  const std::vector<std::uint8_t> garbage(10, 0xEE);
  send(h, {garbage.data(), garbage.size()});
  input.end_batch();
  EXPECT_EQ(report.counters.malformed, 1u);
  EXPECT_THAT(heard.log, ElementsAre("up 0", "gap", "batch end"));
  EXPECT_EQ(input.from(), 0);
}

TEST_F(DatagramInputFromHand, TurnsADatagramWithoutASliceIntoAGap) {
  LinkHeader h = header(LinkHeaderType::slices, session);
  h.sequence = 2;
  send(h);
  input.end_batch();
  EXPECT_EQ(report.counters.malformed, 1u);
  EXPECT_THAT(heard.log, ElementsAre("up 0", "gap", "batch end"));
}

TEST_F(DatagramInputFromHand, IsLostOnGoodbye) {
  send(header(LinkHeaderType::bye, session));
  EXPECT_THAT(heard.log, ElementsAre("up 0", HasSubstr("closed")));
  EXPECT_EQ(input.from(), std::nullopt);
}

TEST_F(DatagramInputFromHand, TellsThatItLivesAndIsLostOnSilence) {
  tick();
  EXPECT_EQ(answers.back().type, LinkHeaderType::alive);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(input.from(), 0) << "silent for " << i << " ticks";
    tick();
  }
  EXPECT_THAT(heard.log, ElementsAre("up 0", "lost: silent"));
  EXPECT_EQ(report.counters.silences, 1u);
}

TEST_F(DatagramInputFromHand, IsLostIfNothingButOldDatagramsCome) {
  datagram(1u << 30, 2);  // somebody's, of the session, and far ahead
  for (std::uint32_t i = 2; i <= 4; ++i) {
    datagram(i, {});
    tick();
  }
  datagram(5, {});
  tick();
  EXPECT_EQ(heard.log.back(), "lost: silent");
  EXPECT_EQ(report.counters.silences, 1u);
}

TEST_F(DatagramInputFromHand, HangsUpAndIsQuietOnceItIsClosed) {
  input.close();
  EXPECT_EQ(answers.back().refusal, Refusal::closing);
  answers.clear();
  send(header(LinkHeaderType::connect, std::uint64_t{9} << 32));
  datagram(2, 2);
  tick();
  EXPECT_THAT(answers, IsEmpty());
  EXPECT_THAT(heard.log, ElementsAre("up 0"));
}

}  // namespace
}  // namespace limb_ring::link
