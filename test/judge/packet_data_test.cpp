// The data of packets that was left out of a recording: as another node has recorded it, or made up.
#include "judge/record.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/packets.h"
#include "support/view.h"

namespace limb_ring::recorder {
namespace {

using Bytes = std::vector<std::uint8_t>;
using test::view;

Bytes packet(std::uint8_t value, std::size_t size = 100) {
  const Bytes data(size, value);
  test::DataPacket fields;
  fields.source = wire::NodeId{3};
  fields.destination = wire::NodeId{5};
  fields.data = {data.data(), data.size()};
  return encoded(fields);
}

/// As it is behind some relays, of which one has written into FBC.
Bytes further_on(Bytes packet) {
  wire::rewrite(packet.data(), packet.size(), 7, 12);
  return packet;
}

Bytes without_data(Bytes packet) {
  std::fill(packet.begin() + wire::kHeaderSize, packet.end() - kTail, std::uint8_t{0});
  return packet;
}

TEST(PacketData, isFilledInWhereverThePacketIs) {
  PacketData data;
  data.keep(view(packet(1)));
  data.keep(view(packet(2)));
  Bytes found = without_data(further_on(packet(1)));
  EXPECT_TRUE(data.fill_in(found.data(), found.size()));
  EXPECT_EQ(found, further_on(packet(1)));
  EXPECT_FALSE(data.is_made_up(view(found)));
  EXPECT_TRUE(data.knows(view(found)));
  EXPECT_FALSE(data.knows(view(packet(3))));
}

TEST(PacketData, isMadeUpIfNobodyKnowsIt) {
  for (const std::size_t size : {kLeastAbridged - wire::kOverhead, std::size_t{101}, wire::kMaxPayload}) {
    PacketData data;
    Bytes made_up = without_data(packet(9, size));
    EXPECT_FALSE(data.fill_in(made_up.data(), made_up.size()));
    EXPECT_TRUE(wire::PacketFields{view(made_up)}.crc_good());
    EXPECT_EQ(without_data(made_up), without_data(packet(9, size))) << "all else is as it was";
    EXPECT_TRUE(data.is_made_up(view(further_on(made_up))));
  }
}

TEST(PacketData, isNoLongerMadeUpOnceItIsKnown) {
  PacketData data;
  Bytes again = without_data(packet(9));
  data.fill_in(again.data(), again.size());
  data.keep(view(packet(9)));
  again = without_data(packet(9));
  EXPECT_TRUE(data.fill_in(again.data(), again.size()));
  EXPECT_EQ(again, packet(9));
}

TEST(PacketData, isNotThatOfAPacketOfAnotherSize) {
  PacketData data;
  data.keep(view(packet(1, 100)));
  Bytes other = without_data(packet(1, 104));
  EXPECT_FALSE(data.fill_in(other.data(), other.size()));
}

TEST(PacketData, isKeptOnlyOfTheNewest) {
  PacketData data;
  data.keep(view(packet(1)));
  for (std::size_t size = 0; size < PacketData::kMost; ++size)
    data.keep(view(packet(static_cast<std::uint8_t>(2 + size % 250), 20 + size / 250)));
  Bytes old = without_data(packet(1));
  EXPECT_FALSE(data.fill_in(old.data(), old.size()));
}

}  // namespace
}  // namespace limb_ring::recorder
