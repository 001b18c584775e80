#include "sim/planned_ring.h"

#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "study/cases.h"
#include "support/node_literal.h"
#include "wire/pcapng.h"

namespace limb_ring::study {
namespace {

std::vector<capture::PcapngReader::Record> records_of(const std::string& file) {
  std::istringstream in(file);
  capture::PcapngReader reader(in, "capture");
  std::vector<capture::PcapngReader::Record> records;
  while (auto record = reader.next()) records.push_back(*record);
  return records;
}

Medium four_nodes() {
  Medium medium;
  medium.nodes = 4;
  return medium;
}

TEST(RingCapture, OfOnePacketShowsItOnEveryLineAtItsTime) {
  std::ostringstream file;
  run_case(Case::alone, four_nodes(), 1, {nullptr, &file});
  const auto records = records_of(file.str());
  ASSERT_EQ(records.size(), 4u);
  std::int64_t before = 0;
  for (unsigned hop = 0; hop < records.size(); ++hop) {
    const auto& packet = std::get<CapturedPacket>(records[hop]);
    EXPECT_EQ(packet.info.from, hop);
    EXPECT_EQ(packet.info.to, (hop + 1) % 4);
    EXPECT_EQ(packet.bytes[2], hop);
    EXPECT_FALSE(packet.info.crc_bad);
    EXPECT_EQ(packet.info.span.count(), (4 + 512) * 8) << "from its header to its trailer at 1 Gbit/s";
    if (hop > 0) {
      EXPECT_EQ(packet.time_ns - before, 512) << "the relay delay";
    }
    before = packet.time_ns;
  }
}

TEST(RingCapture, ChangesNothing) {
  std::ostringstream file;
  const CaseResult watched = run_case(Case::random, four_nodes(), 7, {nullptr, &file});
  EXPECT_EQ(watched.trace_hash, run_case(Case::random, four_nodes(), 7).trace_hash);
  EXPECT_GT(records_of(file.str()).size(), 100u);
}

TEST(RingCapture, ShowsFaultsAndStatesAsEvents) {
  sim::VirtualRingOptions options;
  options.byte_time = std::chrono::nanoseconds(8);
  sim::VirtualRing ring(options);
  std::ostringstream file;
  sim::RingCapture watching(ring, file, sim::plain_names(ring.size()));
  ASSERT_TRUE(ring.join());
  ring.cut(1_id);
  ring.run_for(std::chrono::seconds(1));
  std::set<std::string> seen;
  for (const auto& record : records_of(file.str()))
    if (const auto* event = std::get_if<capture::CapturedEvent>(&record))
      seen.insert(std::to_string(event->node) + " " + event->what);
  for (const char* what : {"0 joining -> up", "1 cut", "2 up -> open_chain"}) EXPECT_EQ(seen.count(what), 1u) << what;
}

}  // namespace
}  // namespace limb_ring::study
