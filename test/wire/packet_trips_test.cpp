// Whose sightings and tries belong together, where numbers come again.
#include "wire/traced_ring.h"

#include <gmock/gmock.h>

#include <set>

#include "support/node_literal.h"
#include "wire/packets.h"

namespace limb_ring::capture {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// A packet of node 0 to node 2 as a ring of three shows it.
struct Sent {
  std::uint8_t sequence = 0, attempt = 0, fill = 0;
  std::uint8_t fbc = wire::kFbcMax;
};

SeenPacket sighting(const Sent& sent, unsigned stage, nanoseconds at) {
  const test::Bytes data(8, sent.fill);
  test::DataPacket packet;
  packet.code = {false, sent.attempt, wire::Sequence{sent.sequence}, {}};
  packet.hop = static_cast<std::uint8_t>(stage / 2);
  packet.destination = 2_id;
  packet.fbc = sent.fbc;
  packet.data = test::view(data);
  const test::Bytes bytes = test::encoded(packet);
  CapturedPacket captured;
  captured.time_ns = at.count();
  captured.info.input = stage % 2 == 1;
  captured.info.from = static_cast<wire::NodeId>(stage / 2);
  captured.info.to = static_cast<wire::NodeId>((stage / 2 + 1) % 3);
  captured.bytes = bytes;
  return seen(captured);
}

constexpr unsigned kHome = 5;

/// All its sightings but those left out, one every us.
void pass(std::vector<SeenPacket>& ring, const Sent& sent, nanoseconds at, const std::set<unsigned>& left_out = {}) {
  for (unsigned stage = 0; stage <= kHome; ++stage)
    if (left_out.count(stage) == 0) ring.push_back(sighting(sent, stage, at + stage * 1us));
}

std::vector<std::size_t> earlier_of(const TracedRing& ring) {
  std::vector<std::size_t> counts;
  for (std::size_t trip = 0; trip < ring.trips(); ++trip) counts.push_back(ring.trace(trip).earlier.size());
  return counts;
}

TEST(PacketTrips, ASightingOfAnotherPacketOfThatNumberBeginsANewTrip) {
  std::vector<SeenPacket> packets;
  pass(packets, {3, 0, 'a'}, 0s, {3, 4, 5});
  pass(packets, {3, 0, 'b'}, 1ms, {0, 1, 2});
  const TracedRing ring(packets);
  ASSERT_EQ(ring.trips(), 2u);
  EXPECT_FALSE(ring.round_trip(1)) << "it was not seen from its source";
}

TEST(PacketTrips, ANumberThatComesAgainBeginsANewTripWhateverIsMissing) {
  std::vector<SeenPacket> packets;
  for (unsigned i = 0; i < 9; ++i)
    pass(packets, {static_cast<std::uint8_t>(i % 8)}, i * 1ms,
         i == 0 ? std::set<unsigned>{2, 3, 4, 5} : std::set<unsigned>{0, 1});
  const TracedRing ring(packets);
  EXPECT_EQ(ring.trips(), 9u);
}

TEST(PacketTrips, ANumberThatComesAgainAfterSecondsWithoutACaptureBeginsANewTrip) {
  std::vector<SeenPacket> packets;
  pass(packets, {3}, 0s, {4, 5});
  pass(packets, {4}, 1ms);
  pass(packets, {3}, 4s, {0, 1, 2, 3});
  EXPECT_EQ(TracedRing(packets).trips(), 3u);
}

TEST(PacketTrips, APacketThatStoodStillForSecondsIsStillTheSame) {
  std::vector<SeenPacket> packets;
  pass(packets, {3}, 0s, {3, 4, 5});
  pass(packets, {3}, 4s, {0, 1, 2});
  const TracedRing ring(packets);
  ASSERT_EQ(ring.trips(), 1u);
  EXPECT_EQ(ring.round_trip(0), 4s + 5us);
}

TEST(EarlierTries, ARefusedPacketAndItsNextTriesBelongTogether) {
  std::vector<SeenPacket> packets;
  for (unsigned i = 0; i < 4; ++i) pass(packets, {static_cast<std::uint8_t>(i), 0, 'a', 0}, i * 64ms);
  EXPECT_THAT(earlier_of(TracedRing(packets)), ElementsAre(0, 1, 2, 3));
}

TEST(EarlierTries, WhatIsSentAfterTheSecondOfARefusalIsAnotherPacket) {
  std::vector<SeenPacket> packets;
  for (unsigned i = 0; i < 98; ++i) pass(packets, {static_cast<std::uint8_t>(i % 8), 0, 'a', 0}, i * 2s);
  EXPECT_THAT(earlier_of(TracedRing(packets)), testing::Each(0));
}

TEST(EarlierTries, NothingIsCountedAsANextTryASecondAfterTheFirstRefusal) {
  std::vector<SeenPacket> packets;
  for (unsigned i = 0; i < 98; ++i) pass(packets, {static_cast<std::uint8_t>(i % 8), 0, 'a', 0}, i * 64ms);
  const TracedRing ring(packets);
  for (std::size_t trip = 0; trip < ring.trips(); ++trip) EXPECT_LE(ring.round_trip(trip), nanoseconds(1200ms));
}

TEST(EarlierTries, OtherDataIsAnotherPacket) {
  std::vector<SeenPacket> packets;
  for (unsigned i = 0; i < 4; ++i)
    pass(packets, {static_cast<std::uint8_t>(i), 0, static_cast<std::uint8_t>(i), 0}, i * 1ms);
  EXPECT_THAT(earlier_of(TracedRing(packets)), testing::Each(0));
}

TEST(EarlierTries, ARetryFollowsItsTryAndNoOlderPacketOfThatNumber) {
  std::vector<SeenPacket> packets;
  pass(packets, {3, 0}, 0s, {4, 5});
  pass(packets, {3, 1}, 100ms);
  pass(packets, {4, 0}, 101ms);
  pass(packets, {3, 1}, 4s);
  EXPECT_THAT(earlier_of(TracedRing(packets)), ElementsAre(0, 1, 0, 0));
}

TEST(HopsOfATrip, SaysHowManyNodesDidNotShowIt) {
  std::vector<SeenPacket> packets;
  pass(packets, {}, 0s, {1, 2, 3, 4});
  pass(packets, {1}, 1ms, {0, 1, 2});
  const TracedRing ring(packets);
  ASSERT_THAT(ring.trace(0).hops, SizeIs(2));
  EXPECT_EQ(ring.trace(0).hops[1].unseen, 2u);
  EXPECT_EQ(ring.trace(0).on_line(1), std::nullopt) << "there are nodes between";
  EXPECT_EQ(ring.trace(1).hops[0].unseen, 2u);
}

TEST(HopsOfATrip, HopThatDoesNotFitItsNodeIsShownAsItIs) {
  std::vector<SeenPacket> packets;
  pass(packets, {}, 0s, {2, 3, 4, 5});
  SeenPacket bypassed = sighting({}, 2, 2us);
  bypassed.info.from = 2;
  bypassed.hop = 1;
  packets.push_back(bypassed);
  const PacketTrace trace = TracedRing(packets).trace(0);
  ASSERT_THAT(trace.hops, SizeIs(3));
  EXPECT_EQ(trace.hops[1].node, 1);
  EXPECT_EQ(trace.hops[2].node, 2);
  EXPECT_THAT(trace.hops[2].behind, IsEmpty());
}

TEST(TracedRing, TimesAtTheEndsOfTheirRangeAreAccepted) {
  std::vector<SeenPacket> packets{sighting({}, 0, nanoseconds::min()), sighting({}, kHome, nanoseconds::max())};
  const TracedRing ring(packets);
  EXPECT_EQ(ring.round_trip(0), nanoseconds::max());
}

}  // namespace
}  // namespace limb_ring::capture
