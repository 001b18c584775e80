#include "wire/packet_assembler.h"

#include <gmock/gmock.h>

#include "support/node_literal.h"
#include "wire/packets.h"

namespace limb_ring::capture {
namespace {

using std::chrono::nanoseconds;
using test::Bytes;
using test::view;
using wire::SliceKind;

struct Seen {
  nanoseconds at;
  CaptureInfo info;
  Bytes bytes;
};

/// The line from node 1 into node 2, and what was seen on it.
class Assembler : public testing::Test {
 protected:
  Assembler() { assembler.set_line(true, 1_id, 2_id); }

  void put(SliceKind kind, wire::ByteView bytes, int at) { assembler.put({kind, bytes}, nanoseconds(at)); }
  /// As far as its last word before the trailer.
  void put_beginning(const Bytes& whole, int at) { put(SliceKind::start, view(whole).first(8), at); }
  void put_end(const Bytes& whole, int at) { put(SliceKind::end, view(whole).from(8), at); }

  std::vector<Seen> seen;
  PacketAssembler assembler{[this](const PacketView& taken) {
    seen.push_back({taken.at, taken.info, {taken.bytes.begin(), taken.bytes.end()}});
  }};
  const Bytes packet = test::data_packet(7, 9, 16);
  const Bytes interrupt = test::interrupt_packet(5, 2, 3);
};

TEST_F(Assembler, GivesAWholePacketAsItIs) {
  put(SliceKind::whole, view(packet), 40);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].bytes, packet);
  EXPECT_EQ(seen[0].at, nanoseconds(40));
  EXPECT_EQ(seen[0].info.span, nanoseconds(0));
  EXPECT_TRUE(seen[0].info.input);
  EXPECT_EQ(seen[0].info.from, 1);
  EXPECT_EQ(seen[0].info.to, 2);
  EXPECT_FALSE(seen[0].info.crc_bad || seen[0].info.retry || seen[0].info.own);
}

TEST_F(Assembler, PutsSlicesTogetherAndSaysHowLongTheyTook) {
  put_beginning(packet, 10);
  put(SliceKind::more, view(packet).from(8).first(8), 20);
  EXPECT_TRUE(seen.empty());
  put(SliceKind::end, view(packet).from(16), 35);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].bytes, packet);
  EXPECT_EQ(seen[0].at, nanoseconds(35));
  EXPECT_EQ(seen[0].info.span, nanoseconds(25));
  EXPECT_FALSE(seen[0].info.crc_bad);
}

TEST_F(Assembler, TellsInsideWhichPacketAnInterruptWas) {
  put_beginning(packet, 10);
  put(SliceKind::interrupt, view(interrupt), 12);
  put_end(packet, 20);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].bytes, interrupt);
  EXPECT_TRUE(seen[0].info.embedded);
  EXPECT_EQ(seen[0].info.carrier_source, 7);
  EXPECT_EQ(seen[0].info.carrier_code, packet[0]);
  EXPECT_EQ(seen[0].info.carrier_offset, 8);
  EXPECT_EQ(seen[1].bytes, packet) << "the interrupt packet is no part of it";
  EXPECT_FALSE(seen[1].info.embedded || seen[1].info.crc_bad);
}

TEST_F(Assembler, KnowsAnInterruptBetweenPacketsFromOneInside) {
  put(SliceKind::whole, view(packet), 1);
  put(SliceKind::interrupt, view(interrupt), 2);
  EXPECT_FALSE(seen.at(1).info.embedded);
}

TEST_F(Assembler, GivesWhatCameOfAnAbortedPacket) {
  put_beginning(packet, 10);
  put(SliceKind::interrupt, view(interrupt), 12);
  put(SliceKind::abort, {}, 20);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].bytes, interrupt) << "it lives on";
  EXPECT_TRUE(seen[1].info.aborted);
  EXPECT_FALSE(seen[1].info.truncated || seen[1].info.crc_bad);
  EXPECT_EQ(seen[1].bytes, Bytes(packet.begin(), packet.begin() + 8));
}

TEST_F(Assembler, CallsAPacketTruncatedIfAnotherBeginsInsideIt) {
  put_beginning(packet, 10);
  put(SliceKind::whole, view(packet), 11);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_TRUE(seen[0].info.truncated);
  EXPECT_FALSE(seen[1].info.truncated);
}

TEST_F(Assembler, CallsAPacketTruncatedIfItsLineWasLost) {
  put_beginning(packet, 10);
  assembler.gap(nanoseconds(50));
  put_end(packet, 60);
  ASSERT_EQ(seen.size(), 1u) << "the rest of it is passed over";
  EXPECT_TRUE(seen[0].info.truncated);
  EXPECT_EQ(seen[0].at, nanoseconds(50));
}

TEST_F(Assembler, CutsAPacketThatIsLongerThanAnyMayBe) {
  const Bytes long_one = test::data_packet(7, 9, 512);
  put(SliceKind::start, view(long_one).first(516), 1);
  put(SliceKind::more, view(long_one).first(12), 2);
  put_end(packet, 3);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_TRUE(seen[0].info.truncated);
}

TEST_F(Assembler, IgnoresAPacketWhoseBeginningItHasNotSeen) {
  put(SliceKind::more, view(packet).first(8), 1);
  put_end(packet, 2);
  put(SliceKind::abort, {}, 3);
  EXPECT_TRUE(seen.empty());
}

TEST_F(Assembler, ForgetsOpenPacketsWhenNobodyObservesAnyMore) {
  put_beginning(packet, 10);
  assembler.reset();
  put(SliceKind::whole, view(packet), 11);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_FALSE(seen[0].info.truncated);
}

TEST_F(Assembler, MarksADamagedPacket) {
  Bytes damaged = packet;
  damaged[10] ^= 1;
  put(SliceKind::whole, view(damaged), 1);
  EXPECT_TRUE(seen.at(0).info.crc_bad);
}

TEST_F(Assembler, MarksARetry) {
  put(SliceKind::whole, view(test::data_packet(7, 9, 8, 2, {false, 2, wire::Sequence{5}, {}})), 1);
  EXPECT_TRUE(seen.at(0).info.retry);
}

TEST_F(Assembler, MarksAnOwnPacketAtTheInputAndAtTheOutput) {
  put(SliceKind::whole, view(test::data_packet(2, 9)), 1);
  assembler.set_line(false, 2_id, 3_id);
  put(SliceKind::whole, view(test::data_packet(2, 9)), 2);
  put(SliceKind::whole, view(test::data_packet(3, 9)), 3);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_TRUE(seen[0].info.own);
  EXPECT_TRUE(seen[1].info.own);
  EXPECT_FALSE(seen[2].info.own);
}

}  // namespace
}  // namespace limb_ring::capture
