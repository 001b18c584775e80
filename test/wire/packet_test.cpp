#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "support/node_literal.h"
#include "wire/data_packet.h"
#include "wire/interrupt_packet.h"

namespace limb_ring::wire {
namespace {

using testing::ElementsAreArray;
using Bytes = std::vector<std::uint8_t>;

Bytes encoded(const DataPacket& packet) {
  Bytes out(packet.data.size + kOverhead);
  EXPECT_EQ(encode(packet, out.data()), out.size());
  return out;
}

// Golden bytes. CRCs computed apart from this code: python3 -c "import zlib; ..." over the bytes
// before them.
TEST(DataPacket, GoldenBytes) {
  const Bytes data{'h', 'i', 0xFB, 0xFD, 0x00};
  DataPacket packet;
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
  DataPacket back;
  ASSERT_EQ(decode({golden.data(), golden.size()}, back), PacketError::none);
  EXPECT_EQ(back.code.attempt, 1);
  EXPECT_EQ(back.code.sequence, 5);
  EXPECT_EQ(back.code.incarnation, 1);
  EXPECT_EQ(back.hop, 3);
  EXPECT_EQ(back.source, 12);
  EXPECT_EQ(back.destination, 7);
  EXPECT_EQ(priority_of(back.pri), 2);
  EXPECT_EQ(channel_of(back.pri), 4);
  EXPECT_EQ(Bytes(back.data.begin(), back.data.end()), data);
}

TEST(InterruptPacket, GoldenBytes) {
  InterruptPacket packet;
  packet.code = {true, 0, Sequence{2}, Incarnation{1}};
  packet.hop = 15;
  packet.fbc = 1;
  packet.destination = 12_id;
  packet.factor = Factor{6};
  const Bytes golden{0x62, 0xFB, 0x0F, 0x00,  // incarnation 1, INTP, try 0, sequence 2 | SOP | HOP 15 | SID 0
                     0xFD, 0x01, 0x0C, 0x06,  // EOP | FBC 1: pin pulled | DID 12 | factor 6
                     0x50, 0xDB, 0xEA, 0x2D};
  EXPECT_THAT(encode(packet), ElementsAreArray(golden));
  InterruptPacket back;
  ASSERT_EQ(decode({golden.data(), golden.size()}, back), PacketError::none);
  EXPECT_EQ(back.factor, 6);
  EXPECT_EQ(back.fbc, 1);
}

TEST(DataPacket, EveryLengthComesBack) {
  Bytes data(kMaxPayload);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(i);
  for (std::size_t size = 1; size <= kMaxPayload; ++size) {
    const Bytes bytes = encoded({{}, 0, 1_id, kFbcUntaken, 2_id, 0, {data.data(), size}});
    DataPacket back;
    ASSERT_EQ(decode({bytes.data(), bytes.size()}, back), PacketError::none);
    ASSERT_EQ(Bytes(back.data.begin(), back.data.end()), Bytes(data.begin(), data.begin() + size));
  }
}

TEST(DataPacket, AnyFlippedBitIsDetected) {
  const Bytes data{1, 2, 3, 4, 5};
  Bytes bytes = encoded({{}, 0, 1_id, kFbcUntaken, 2_id, 0, {data.data(), data.size()}});
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    bytes[bit / 8] ^= 1 << bit % 8;
    DataPacket back;
    EXPECT_NE(decode({bytes.data(), bytes.size()}, back), PacketError::none) << "bit " << bit;
    bytes[bit / 8] ^= 1 << bit % 8;
  }
}

TEST(DataPacket, AnyCutIsDetected) {
  const Bytes data(100, 0xFD);
  const Bytes bytes = encoded({{}, 0, 1_id, kFbcUntaken, 2_id, 0, {data.data(), data.size()}});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    DataPacket back;
    EXPECT_NE(decode({bytes.data(), size}, back), PacketError::none) << size;
  }
}

TEST(Packet, RewritingCarriesAGoodCrcAlong) {
  const Bytes data(77, 0x3C);
  Bytes bytes = encoded({{}, 0, 1_id, kFbcUntaken, 2_id, 0, {data.data(), data.size()}});
  for (int hop = 1; hop < 255; ++hop) {
    rewrite(bytes.data(), bytes.size(), static_cast<std::uint8_t>(hop), static_cast<std::uint8_t>(255 - hop));
    ASSERT_EQ(check_packet({bytes.data(), bytes.size()}, false), PacketError::none) << hop;
  }
}

TEST(Packet, RewritingNeverMakesABadCrcGood) {
  const Bytes data(77, 0x3C);
  Bytes bytes = encoded({{}, 0, 1_id, kFbcUntaken, 2_id, 0, {data.data(), data.size()}});
  bytes[20] ^= 0x10;
  for (int hop = 1; hop < 255; ++hop) {
    rewrite(bytes.data(), bytes.size(), static_cast<std::uint8_t>(hop), static_cast<std::uint8_t>(hop));
    ASSERT_EQ(check_packet({bytes.data(), bytes.size()}, false), PacketError::crc) << hop;
  }
}

TEST(Packet, WhatIsWrongWithItIsSaid) {
  const Bytes data(8, 0x3C);
  const Bytes good = encoded({{}, 0, 1_id, kFbcUntaken, 2_id, 0, {data.data(), data.size()}});
  const auto with_byte = [&good](std::size_t at, std::uint8_t value) {
    Bytes bytes = good;
    bytes[at] = value;
    return check_packet({bytes.data(), bytes.size()}, false);
  };
  EXPECT_EQ(check_packet({good.data(), good.size()}, false), PacketError::none);
  EXPECT_EQ(check_packet({good.data(), kMinDataPacketSize - 1}, false), PacketError::size);
  EXPECT_EQ(check_packet({good.data(), good.size()}, true), PacketError::size);
  EXPECT_EQ(with_byte(field::kCode, 0x20), PacketError::header);
  EXPECT_EQ(with_byte(field::kSop, 0), PacketError::header);
  EXPECT_EQ(with_byte(field::kSource, 0xFF), PacketError::header);
  EXPECT_EQ(with_byte(good.size() - field::kEopFromEnd, 0), PacketError::trailer);
  EXPECT_EQ(with_byte(kHeaderSize, 0), PacketError::crc);
  EXPECT_STREQ(to_string(PacketError::none), "good");
  EXPECT_STREQ(to_string(PacketError::size), "a size no packet of its kind has");
  EXPECT_STREQ(to_string(PacketError::header), "no valid header (kind, SOP or SID)");
  EXPECT_STREQ(to_string(PacketError::trailer), "no EOP where the trailer should begin");
  EXPECT_STREQ(to_string(PacketError::crc), "wrong CRC");
}

TEST(DataPacket, MayHaveEverySizeFrom13To524Bytes) {
  for (const std::size_t size : {std::size_t{1}, std::size_t{512}}) {
    const Bytes data(size, 1);
    const Bytes bytes = encoded({{}, 0, 1_id, kFbcUntaken, 2_id, 0, {data.data(), data.size()}});
    EXPECT_EQ(bytes.size(), size + 12);
    EXPECT_EQ(check_packet({bytes.data(), bytes.size()}, false), PacketError::none);
  }
  EXPECT_EQ(check_packet({Bytes(525).data(), 525}, false), PacketError::size);
  EXPECT_EQ(check_packet({Bytes(12).data(), 12}, false), PacketError::size);
}

TEST(InterruptPacket, FactorBeyondSevenIsRefused) {
  InterruptBytes bytes = encode(InterruptPacket{});
  bytes[7] = 8;
  store_u32(bytes.data() + 8, crc32({bytes.data(), 8}));
  InterruptPacket back;
  EXPECT_EQ(decode({bytes.data(), bytes.size()}, back), PacketError::trailer);
}

TEST(Channels, HaveTheNumbersOfTheProtocol) {
  EXPECT_EQ(id_of(Channel::user), 0);
  EXPECT_EQ(id_of(Channel::control), 1);
  EXPECT_EQ(id_of(Channel::joint), 2);
  EXPECT_EQ(id_of(Channel::fragment), 3);
}

}  // namespace
}  // namespace limb_ring::wire
