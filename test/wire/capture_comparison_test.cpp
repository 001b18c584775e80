// Where two captures part: `ring_sim compare-traces`.
#include "wire/capture_comparison.h"

#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "support/node_literal.h"
#include "wire/packets.h"

namespace limb_ring::capture {
namespace {

const RingNames kTwoNodes{"robot", {{1_id, "hip"}, {2_id, "knee"}}};

struct Written {
  std::int64_t time_ns = 1000;
  std::uint32_t lost_before = 0;
  CaptureInfo info;
  test::Bytes bytes = test::data_packet(1, 2, 5);
};

/// A packet, an event, and what `last` writes.
std::string file_with(const std::function<void(PcapngWriter&)>& last) {
  std::ostringstream out;
  PcapngWriter writer(out, kTwoNodes);
  writer.packet(500, {}, test::view(test::data_packet(2, 1, 1)));
  writer.event(700, 2_id, "killed");
  last(writer);
  return out.str();
}

std::string file_with(const Written& packet) {
  return file_with([&](PcapngWriter& writer) {
    writer.packet(packet.time_ns, packet.info, test::view(packet.bytes), packet.lost_before);
  });
}

CaptureComparison compared(const std::string& first, const std::string& second) {
  std::istringstream a(first), b(second);
  PcapngReader reader_a(a, "a"), reader_b(b, "b");
  return compare(reader_a, reader_b);
}

std::string difference_of(const Written& other) {
  const CaptureComparison result = compared(file_with(Written{}), file_with(other));
  EXPECT_EQ(result.equal, 2u);
  return result.first && result.second ? difference(*result.first, *result.second) : "none";
}

TEST(CaptureComparison, EqualCapturesAreTheSame) {
  const CaptureComparison result = compared(file_with(Written{}), file_with(Written{}));
  EXPECT_TRUE(result.same());
  EXPECT_EQ(result.equal, 3u);
}

TEST(CaptureComparison, NamesWhatOfThePacketDiffers) {
  Written other;
  other.time_ns = 1001;
  EXPECT_EQ(difference_of(other), "time");
  other = {};
  other.bytes[9] ^= 1;
  EXPECT_EQ(difference_of(other), "bytes from 9, condition");
  other = {};
  other.bytes.pop_back();
  EXPECT_EQ(difference_of(other), "size, bytes from " + std::to_string(other.bytes.size()) + ", condition");
  other = {};
  other.lost_before = 3;
  EXPECT_EQ(difference_of(other), "packets lost before it");
}

TEST(CaptureComparison, NamesWhatOfItsInfoDiffers) {
  const auto with = [](const std::function<void(CaptureInfo&)>& change) {
    Written other;
    change(other.info);
    return difference_of(other);
  };
  EXPECT_EQ(with([](CaptureInfo& info) { info.to = 2; }), "line");
  EXPECT_EQ(with([](CaptureInfo& info) { info.crc_bad = true; }), "condition");
  EXPECT_EQ(with([](CaptureInfo& info) { info.retry = true; }), "condition");
  EXPECT_EQ(with([](CaptureInfo& info) { info.embedded = true; }), "the packet it is in");
  EXPECT_EQ(with([](CaptureInfo& info) { info.span = std::chrono::nanoseconds(7); }), "time it took");
}

TEST(CaptureComparison, EventsAreCompared) {
  const auto event = [](std::int64_t time_ns, wire::NodeId node, const char* what) {
    return file_with([=](PcapngWriter& writer) { writer.event(time_ns, node, what); });
  };
  const std::string first = event(1000, 1_id, "frozen");
  const auto difference_to = [&](const std::string& other) {
    const CaptureComparison result = compared(first, other);
    return result.first && result.second ? difference(*result.first, *result.second) : "none";
  };
  EXPECT_EQ(difference_to(first), "none");
  EXPECT_EQ(difference_to(event(1002, 1_id, "frozen")), "time");
  EXPECT_EQ(difference_to(event(1000, 2_id, "thawed")), "node, event");
  EXPECT_EQ(difference_to(file_with(Written{})), "one is a packet, the other an event");
}

TEST(CaptureComparison, OneThatEndsEarlierIsNotTheSame) {
  const CaptureComparison result = compared(file_with(Written{}), file_with([](PcapngWriter&) {}));
  EXPECT_EQ(result.equal, 2u);
  EXPECT_TRUE(result.first.has_value());
  EXPECT_FALSE(result.second.has_value());
  EXPECT_FALSE(result.same());
}

}  // namespace
}  // namespace limb_ring::capture
