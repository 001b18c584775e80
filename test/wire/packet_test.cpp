#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/node_literal.h"
#include "support/packets.h"

namespace limb_ring::wire {
namespace {

using testing::ElementsAreArray;
using Bytes = std::vector<std::uint8_t>;

/// A DATP of node 1 to node 2.
Bytes with(const Bytes& data) {
  test::DataPacket packet;
  packet.source = 1_id;
  packet.destination = 2_id;
  packet.data = {data.data(), data.size()};
  return encoded(packet);
}

PacketFields fields(const Bytes& bytes) { return {{bytes.data(), bytes.size()}}; }

TEST(Bytes, OfANumberBeginWithTheHighest) {
  std::array<std::uint8_t, 8> bytes{};
  store_u64(bytes.data(), 0x0102030405060708);
  EXPECT_THAT(bytes, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_EQ(load_u64(bytes.data()), 0x0102030405060708u);
}

// protocol.md section 4.8
TEST(BootNumber, IsTheNextOneUnlessTheWallClockIsHigher) {
  EXPECT_EQ(next_boot(1000, 900), 1001u);
  EXPECT_EQ(next_boot(1000, 1001), 1001u);
  EXPECT_EQ(next_boot(1000, 1002), 1004u + 1u);
}

// Golden bytes. CRCs computed apart from this code: python3 -c "import zlib; ..." over the bytes
// before them.
TEST(DataPacket, GoldenBytes) {
  const Bytes data{'h', 'i', 0xFB, 0xFD, 0x00};
  test::DataPacket packet;
  packet.code = {false, 1, Sequence{5}, Incarnation{1}};
  packet.hop = 3;
  packet.source = 12_id;
  packet.destination = 7_id;
  packet.pri = pri_byte(Priority{2}, ChannelId{4});
  packet.data = {data.data(), data.size()};
  const Bytes golden{0x4D, 0xFB, 0x03, 0x0C,        // incarnation 1, DATP, try 1, sequence 5 | SOP | HOP 3 | SID 12
                     'h',  'i',  0xFB, 0xFD, 0x00,  // any value is legal data
                     0xFD, 0xFF, 0x07, 0x12,        // EOP | FBC untaken | DID 7 | channel 4, priority 2
                     0xD2, 0x12, 0x9A, 0x12};
  EXPECT_THAT(encoded(packet), ElementsAreArray(golden));
  const PacketFields back = fields(golden);
  EXPECT_TRUE(header_valid(back.bytes, false));
  EXPECT_TRUE(trailer_valid(back.bytes));
  EXPECT_TRUE(back.crc_good());
  EXPECT_FALSE(back.code().interrupt);
  EXPECT_EQ(back.code().attempt, 1);
  EXPECT_EQ(back.code().sequence, 5);
  EXPECT_EQ(back.code().incarnation, 1);
  EXPECT_EQ(back.hop(), 3);
  EXPECT_EQ(back.source(), 12);
  EXPECT_EQ(back.fbc(), kFbcUntaken);
  EXPECT_EQ(back.destination(), 7);
  EXPECT_EQ(priority_of(back.last()), 2);
  EXPECT_EQ(channel_of(back.last()), 4);
  EXPECT_EQ(Bytes(back.data().begin(), back.data().end()), data);
}

TEST(InterruptPacket, GoldenBytes) {
  test::InterruptPacket packet;
  packet.code = {true, 0, Sequence{2}, Incarnation{1}};
  packet.hop = 15;
  packet.fbc = 1;
  packet.destination = 12_id;
  packet.factor = Factor{6};
  const Bytes golden{0x62, 0xFB, 0x0F, 0x00,  // incarnation 1, INTP, try 0, sequence 2 | SOP | HOP 15 | SID 0
                     0xFD, 0x01, 0x0C, 0x06,  // EOP | FBC 1: pin pulled | DID 12 | factor 6
                     0x50, 0xDB, 0xEA, 0x2D};
  EXPECT_THAT(encoded(packet), ElementsAreArray(golden));
  const PacketFields back = fields(golden);
  EXPECT_TRUE(header_valid(back.bytes, true));
  EXPECT_TRUE(back.crc_good());
  EXPECT_EQ(factor_of(back.last()), 6);
  EXPECT_EQ(back.fbc(), 1);
}

TEST(Packet, AnyFlippedBitIsDetected) {
  Bytes bytes = with({1, 2, 3, 4, 5});
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    bytes[bit / 8] ^= 1 << bit % 8;
    EXPECT_FALSE(fields(bytes).crc_good()) << "bit " << bit;
    bytes[bit / 8] ^= 1 << bit % 8;
  }
}

TEST(Packet, RewritingCarriesAGoodCrcAlongAtEverySize) {
  for (std::size_t size = 1; size <= kMaxPayload; ++size) {
    Bytes bytes = with(Bytes(size, 0x3C));
    for (const int hop : {1, 2, 77, 254}) {
      rewrite(bytes.data(), bytes.size(), static_cast<std::uint8_t>(hop), static_cast<std::uint8_t>(255 - hop));
      ASSERT_TRUE(fields(bytes).crc_good()) << size << ", " << hop;
    }
  }
}

TEST(Packet, RewritingNeverMakesABadCrcGood) {
  Bytes bytes = with(Bytes(77, 0x3C));
  bytes[20] ^= 0x10;
  for (int hop = 1; hop < 255; ++hop) {
    rewrite(bytes.data(), bytes.size(), static_cast<std::uint8_t>(hop), static_cast<std::uint8_t>(hop));
    ASSERT_FALSE(fields(bytes).crc_good()) << hop;
  }
}

TEST(Packet, BeginsWithAHeaderOfItsKindAndHasAnEop) {
  const Bytes good = with(Bytes(8, 0x3C));
  const auto header_with = [&good](std::size_t at, std::uint8_t value) {
    Bytes bytes = good;
    bytes[at] = value;
    return header_valid({bytes.data(), bytes.size()}, false);
  };
  EXPECT_TRUE(header_valid(fields(good).bytes, false));
  EXPECT_FALSE(header_valid(fields(good).bytes, true));
  EXPECT_FALSE(header_with(field::kCode, 0x20));
  EXPECT_FALSE(header_with(field::kSop, 0));
  EXPECT_FALSE(header_with(field::kSource, 0xFF));
  Bytes without_end = good;
  without_end[good.size() - field::kEopFromEnd] = 0;
  EXPECT_TRUE(trailer_valid(fields(good).bytes));
  EXPECT_FALSE(trailer_valid(fields(without_end).bytes));
}

TEST(DataPacket, MayHaveEverySizeFrom13To524Bytes) {
  EXPECT_EQ(with(Bytes(1)).size(), kMinDataPacketSize);
  EXPECT_EQ(kMinDataPacketSize, 13u);
  EXPECT_EQ(with(Bytes(kMaxPayload)).size(), kMaxDataPacketSize);
  EXPECT_EQ(kMaxDataPacketSize, 524u);
}

TEST(Channels, HaveTheNumbersOfTheProtocol) {
  EXPECT_EQ(id_of(Channel::user), 0);
  EXPECT_EQ(id_of(Channel::control), 1);
  EXPECT_EQ(id_of(Channel::joint), 2);
  EXPECT_EQ(id_of(Channel::fragment), 3);
}

}  // namespace
}  // namespace limb_ring::wire
