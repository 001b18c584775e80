// An INTP inside a DATP: at every permitted place, through every relay, both arrive intact.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

using testing::ElementsAre;
using wire::SliceKind;

/// Lengths of every remainder modulo 4, the shortest and the longest among them.
const std::size_t kLengths[] = {1, 2, 3, 4, 5, 6, 7, 8, 21, 22, 23, 24, 509, 510, 511, 512};

/// A DATP as slices with an INTP before the words that begin at each of `places` (0: right behind
/// the header).
void feed(SoloNode& solo, const Bytes& packet, const std::vector<std::size_t>& places, std::uint8_t& sequence) {
  std::size_t at = 4;
  solo.receive(SliceKind::start, {packet.begin(), packet.begin() + 4});
  for (std::size_t place : places) {
    const std::size_t until = 4 + place;
    if (until > at)
      solo.receive(SliceKind::more,
                   {packet.begin() + static_cast<long>(at), packet.begin() + static_cast<long>(until)});
    at = until;
    solo.receive(SliceKind::interrupt, foreign_interrupt(0, 1, 1, sequence++ & 7));
  }
  solo.receive(SliceKind::end, {packet.begin() + static_cast<long>(at), packet.end()});
}

/// Takes what a line carries apart again, as the next node does.
struct CarriedLine {
  Bytes data;
  std::vector<Bytes> interrupts;
  explicit CarriedLine(const std::vector<SoloNode::Out>& slices) {
    for (const auto& slice : slices)
      if (slice.kind == SliceKind::interrupt)
        interrupts.push_back(slice.bytes);
      else
        data.insert(data.end(), slice.bytes.begin(), slice.bytes.end());
  }
};

bool good(const Bytes& bytes) { return wire::PacketFields{{bytes.data(), bytes.size()}}.crc_good(); }

TEST(Embedding, AtEveryWordOfDatpsOfEveryLengthBothAreTakenAndPassedOn) {
  for (std::size_t length : kLengths) {
    SoloNode solo;
    solo.join();
    std::uint8_t sequence = 0, data_sequence = 0;
    std::uint64_t pulled = 0;
    for (std::size_t place = 0; place <= length / 4 * 4; place += 4) {
      const Bytes payload = pattern(length, static_cast<unsigned>(place));
      const Foreign packet = Foreign{0, 1}.with_sequence(data_sequence++ & 7);
      feed(solo, packet.with(payload), {place}, sequence);
      ASSERT_THAT(solo.packets(), ElementsAre(payload)) << length << " at " << place;
      ASSERT_EQ(solo.counters().pins_pulled, ++pulled);
      const CarriedLine line(solo.line());
      ASSERT_TRUE(good(line.data)) << length << " at " << place;
      ASSERT_EQ(line.data.size(), length + 12);
      ASSERT_EQ(line.interrupts.size(), 1u);
      ASSERT_TRUE(good(line.interrupts[0]));
    }
  }
}

TEST(Embedding, SeveralInOneDatpKeepTheirOrder) {
  SoloNode solo;
  solo.join();
  std::uint8_t sequence = 0;
  feed(solo, Foreign{0, 1}.with(pattern(33)), {0, 0, 4, 16, 32, 32}, sequence);
  const CarriedLine line(solo.line());
  ASSERT_EQ(line.interrupts.size(), 6u);
  for (std::uint8_t i = 0; i < 6; ++i) EXPECT_EQ(wire::code_of(line.interrupts[i][0]).sequence, i);
  EXPECT_TRUE(good(line.data));
  EXPECT_THAT(solo.packets(), ElementsAre(pattern(33)));
}

/// On a line with a data rate: node 0 sends one DATP, and node `from` an INTP at every time.
TEST(Embedding, APicosecondAfterAWordTheInterruptWaitsForTheNextOne) {
  SoloNode solo(8ns);
  solo.join();
  const Bytes data = pattern(64);
  solo.node().send(send_of(1, 1, 2_id, data), solo.now());
  solo.run();
  solo.line();
  const Duration word = 4 * 8ns;
  solo.run_for(4 * word + Duration{1});  // the header and three words
  solo.node().interrupt({1, 2, 2_id, wire::Factor{1}}, solo.now());
  solo.run();
  EXPECT_TRUE(solo.line().empty());
  solo.run_for(word - Duration{1});
  const auto out = solo.line();
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[0].bytes.size(), 16u);
  EXPECT_EQ(out[1].kind, SliceKind::interrupt);
}

struct PacedEmbedding : testing::TestWithParam<std::size_t> {
  static constexpr unsigned kNodes = 4;
  VirtualRing ring{gigabit(kNodes)};
  void SetUp() override {
    ASSERT_TRUE(ring.join());
    ring.run_for(1ms);
  }

  /// @return how long the INTP took to reach its destination `hops` further, beyond the bare line
  Duration waited(NodeId from, unsigned hops, Duration at, const Bytes& payload) {
    Time pin{};
    ring.on_event = [&](NodeId, const Event& e) {
      if (std::holds_alternative<PinPulled>(e.what)) pin = e.at;
    };
    const Time start = ring.now();
    const auto data = ring.send(0_id, 3_id, payload);
    std::uint32_t interrupt = 0;
    const auto destination = static_cast<NodeId>((from + hops) % kNodes);
    ring.at(start + at, [&] { interrupt = ring.interrupt(from, destination, 1); });
    ring.run_for(20us);
    EXPECT_EQ(outcome_of(ring, 0_id, data).outcome, Outcome::delivered);
    EXPECT_EQ(outcome_of(ring, from, interrupt).outcome, Outcome::delivered);
    EXPECT_EQ(payloads(ring.log(3_id)).back(), payload);
    return pin - (start + at) - hops * Duration{512ns} - 96ns;
  }
  Duration time_of(std::size_t bytes) { return Duration{8ns} * static_cast<int>(bytes); }
};

TEST_P(PacedEmbedding, AtEveryInstantBothArriveAndTheInterruptWaitsNoLongerThanItMay) {
  const Bytes payload = pattern(GetParam(), 7);
  const Duration tail = time_of(GetParam() % 4 + 8);
  const Duration most = std::max({tail, time_of(4)});
  const Duration packet = time_of(GetParam() + 12);
  Duration longest{0};
  for (Duration at{0}; at <= packet + 96ns; at += GetParam() > 64 ? Duration{52ns} : Duration{4ns}) {
    const Duration wait = waited(0_id, 1, at, payload);
    ASSERT_GE(wait, Duration{0});
    ASSERT_LE(wait, most) << picoseconds(at);
    longest = std::max(longest, wait);
  }
  EXPECT_GE(longest, most - 52ns) << "the sweep met the worst place";
}

TEST_P(PacedEmbedding, InARelayedDatpToo) {
  const Bytes payload = pattern(GetParam(), 7);
  const Duration packet = time_of(GetParam() + 12);
  for (Duration at = 512ns; at <= 512ns + packet; at += GetParam() > 64 ? Duration{52ns} : Duration{4ns})
    ASSERT_LE(waited(1_id, 1, at, payload), std::max(time_of(GetParam() % 4 + 8), time_of(4))) << picoseconds(at);
}

// It is taken out midway, at its own node, and the DATP around it goes on.
TEST_P(PacedEmbedding, AndIsTakenOutOnItsWayRoundWhileTheDatpGoesOn) {
  const Bytes payload = pattern(GetParam(), 7);
  for (Duration at{0}; at <= time_of(GetParam() + 12); at += time_of(4) * (GetParam() > 64 ? 8 : 1)) {
    waited(0_id, 2, at, payload);
    waited(3_id, 3, at, payload);
  }
}

TEST_P(PacedEmbedding, SeveralFromEveryNodeInOneDatp) {
  const Bytes payload = pattern(GetParam(), 7);
  const Time start = ring.now();
  const auto data = ring.send(0_id, 3_id, payload);
  unsigned asked = 0;
  for (Duration at{0}; at < time_of(GetParam() + 12); at += 120ns)
    for (NodeId id{0}; id < kNodes; ++id)
      ring.at(start + at,
              [&, id] { asked += ring.interrupt(id, static_cast<NodeId>((id + 1 + asked % 3) % kNodes), 2) != 0; });
  ring.run_for(2ms);
  EXPECT_EQ(outcome_of(ring, 0_id, data).outcome, Outcome::delivered);
  EXPECT_THAT(payloads(ring.log(3_id)), ElementsAre(payload));
  std::size_t pulled = 0;
  for (NodeId id{0}; id < kNodes; ++id) pulled += pins(ring.log(id)).size();
  EXPECT_EQ(
      pulled, asked - [&] {
        std::uint64_t n = 0;
        for (NodeId id{0}; id < kNodes; ++id) n += ring.counters(id).ended_rejected;
        return n;
      }());
}

INSTANTIATE_TEST_SUITE_P(Lengths, PacedEmbedding, testing::ValuesIn(kLengths));

}  // namespace
}  // namespace limb_ring::core
