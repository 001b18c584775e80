#include "wire/packet_filter.h"

#include <string>

#include <gtest/gtest.h>

#include "wire/packets.h"

namespace limb_ring::capture {
namespace {

using std::chrono::milliseconds;
using test::Bytes;

PacketView seen_in(const Bytes& bytes) { return {{}, {}, test::view(bytes)}; }
PacketView seen_out(const Bytes& bytes) {
  PacketView packet = seen_in(bytes);
  packet.info.input = false;
  return packet;
}

const std::uint8_t kControlPri = wire::pri_byte(wire::Priority{0}, wire::id_of(wire::Channel::control));
const Bytes kData = test::data_packet(1, 2, 8, wire::pri_byte(wire::Priority{3}, wire::ChannelId{5}));
const Bytes kControl = test::data_packet(1, wire::kBroadcast, 9, kControlPri);
const Bytes kInterrupt = test::interrupt_packet(1, 2, 4);

TEST(CaptureFilter, PassesEverythingThatComesInUnlessAskedForLess) {
  const Filter filter;
  for (const Bytes* bytes : {&kData, &kControl, &kInterrupt}) {
    EXPECT_TRUE(filter.passes(seen_in(*bytes)));
    EXPECT_FALSE(filter.passes(seen_out(*bytes)));
  }
}

TEST(CaptureFilter, ChoosesTheLine) {
  Filter filter;
  filter.input = false;
  filter.output = true;
  EXPECT_FALSE(filter.passes(seen_in(kData)));
  EXPECT_TRUE(filter.passes(seen_out(kData)));
}

TEST(CaptureFilter, ChoosesKinds) {
  Filter filter;
  filter.kinds.set(static_cast<std::size_t>(Kind::interrupt));
  EXPECT_TRUE(filter.passes(seen_in(kInterrupt)));
  EXPECT_FALSE(filter.passes(seen_in(kData)));
  EXPECT_FALSE(filter.passes(seen_in(kControl)));
  filter.kinds = 1u << static_cast<unsigned>(Kind::control);
  EXPECT_TRUE(filter.passes(seen_in(kControl)));
  EXPECT_FALSE(filter.passes(seen_in(kData)));
}

TEST(CaptureFilter, ChoosesSourcesAndDestinations) {
  Filter filter;
  filter.source.set(1).set(3);
  EXPECT_TRUE(filter.passes(seen_in(kData)));
  EXPECT_FALSE(filter.passes(seen_in(test::data_packet(2, 2))));
  filter.destination.set(wire::kBroadcast);
  EXPECT_FALSE(filter.passes(seen_in(kData)));
  EXPECT_TRUE(filter.passes(seen_in(kControl)));
}

TEST(CaptureFilter, ChoosesPrioritiesAndChannelsOfDataPackets) {
  Filter filter;
  filter.priority.set(3);
  EXPECT_TRUE(filter.passes(seen_in(kData)));
  EXPECT_FALSE(filter.passes(seen_in(kControl)));
  EXPECT_FALSE(filter.passes(seen_in(kInterrupt))) << "it has none";
  filter.channel.set(6);
  EXPECT_FALSE(filter.passes(seen_in(kData)));
  filter.channel.set(5);
  EXPECT_TRUE(filter.passes(seen_in(kData)));
}

TEST(CaptureFilter, KnowsOfABrokenOffPacketOnlyItsHeader) {
  const Bytes header(kData.begin(), kData.begin() + 8);
  PacketView packet = seen_in(header);
  packet.info.aborted = true;
  Filter filter;
  filter.source.set(1);
  EXPECT_TRUE(filter.passes(packet));
  filter.destination.set(2);
  EXPECT_FALSE(filter.passes(packet));
}

TEST(CaptureSelection, CountsEveryPacketUnderOneName) {
  Choice choice;
  choice.filter.source.set(1);
  choice.sample = 2;
  choice.limit_per_s = 2;
  Selection selection(choice);
  unsigned taken = 0;
  for (int i = 0; i < 10; ++i) taken += selection.takes(seen_in(kData)) ? 1 : 0;
  for (int i = 0; i < 3; ++i) taken += selection.takes(seen_in(test::data_packet(2, 1))) ? 1 : 0;
  const CaptureCounts& counts = selection.counts();
  EXPECT_EQ(taken, 2u);
  EXPECT_EQ(counts.seen, 13u);
  EXPECT_EQ(counts.filtered, 3u);
  EXPECT_EQ(counts.sampled_out, 5u);
  EXPECT_EQ(counts.limited, 3u);
}

TEST(CaptureSelection, LimitsEachSecondByItself) {
  Choice choice;
  choice.limit_per_s = 1;
  Selection selection(choice);
  PacketView packet = seen_in(kData);
  std::string taken;
  for (const int at : {0, 999, 1000, 1001, 2500}) {
    packet.at = milliseconds(at);
    taken += selection.takes(packet) ? "y" : "n";
  }
  EXPECT_EQ(taken, "ynyny");
}

TEST(CaptureSelection, SaysHowManyWereLostSinceTheLastOneWasGiven) {
  Selection selection(Choice{});
  selection.lost();
  selection.lost();
  EXPECT_EQ(selection.lost_before(), 2u);
  selection.given();
  EXPECT_EQ(selection.lost_before(), 0u);
  EXPECT_EQ(selection.counts().lost, 2u);
  EXPECT_EQ(selection.counts().given, 1u);
}

}  // namespace
}  // namespace limb_ring::capture
