#include "tools/ringctl/traffic_again.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "support/own_folder.h"
#include "tools/ringctl/run_ringctl.h"
#include "tools/ringctl/screen.h"
#include "wire/packets.h"

namespace limb_ring::ringctl {
namespace {

/// A capture of a ring of nodes 0 to 3 as it is written.
class Plan : public testing::Test {
 protected:
  void seen(std::int64_t at, int from, int to, const test::Bytes& bytes) {
    CaptureInfo info;
    info.from = static_cast<wire::NodeId>(from);
    info.to = static_cast<wire::NodeId>(to);
    info.retry = wire::code_of(bytes[0]).attempt != 0;
    info.crc_bad = !wire::PacketFields{test::view(bytes)}.crc_good();
    writer.packet(at, info, test::view(bytes));
  }
  ReplayPlan plan() {
    std::istringstream in(file.str());
    capture::PcapngReader reader(in, "file");
    return plan_replay(reader);
  }

  std::ostringstream file;
  capture::PcapngWriter writer{file, {"robot", {}}};
};

TEST_F(Plan, KeepsDistancesAndContents) {
  seen(1000, 0, 1, test::data_packet(0, 2, 3, wire::pri_byte(wire::Priority{1}, wire::ChannelId{4})));
  seen(1700, 0, 1, test::interrupt_packet(0, 3, 6));
  const auto sends = plan().sends;
  ASSERT_EQ(sends.size(), 2u);
  EXPECT_EQ(sends[0].after_ns, 0);
  EXPECT_EQ(sends[0].destination, 2);
  EXPECT_EQ(sends[0].last, wire::pri_byte(wire::Priority{1}, wire::ChannelId{4}));
  EXPECT_EQ(sends[0].data, (test::Bytes{0, 1, 2}));
  EXPECT_EQ(sends[1].after_ns, 700);
  EXPECT_TRUE(sends[1].interrupt);
  EXPECT_EQ(sends[1].last, 6);
}

TEST_F(Plan, TakesEachSourceFromItsOutputLineElseFromOneOtherLine) {
  for (const int line : {2, 3, 0, 1}) seen(line, line, (line + 1) % 4, test::data_packet(0, 2));
  for (const int line : {1, 2}) seen(10 + line, line, line + 1, test::data_packet(3, 2));
  const ReplayPlan made = plan();
  ASSERT_EQ(made.sends.size(), 2u);
  EXPECT_EQ(made.sends[0].source, 0);
  EXPECT_EQ(made.sends[1].source, 3);
  EXPECT_EQ(made.sends[1].after_ns, 11 - 0) << "node 0's is the one on the line out of it";
  EXPECT_EQ(made.elsewhere, 4u);
}

TEST_F(Plan, LeavesControlBrokenAndRepeatedPacketsOut) {
  const test::Bytes good = test::data_packet(0, 2, 8, 2, {false, 0, wire::Sequence{5}, {}});
  test::Bytes bad = good;
  bad[5] ^= 1;
  seen(0, 0, 1, test::data_packet(0, wire::kBroadcast, 9, wire::pri_byte(wire::Priority{0}, wire::ChannelId{1})));
  seen(1, 0, 1, good);
  seen(2, 0, 1, test::data_packet(0, 2, 8, 2, {false, 1, wire::Sequence{5}, {}}));
  seen(3, 0, 1, bad);
  seen(4, 0, 1, test::data_packet(0, 2, 8, 2, {false, 1, wire::Sequence{6}, {}}));  // its first try was not captured
  const ReplayPlan made = plan();
  EXPECT_EQ(made.sends.size(), 2u);
  EXPECT_EQ(made.control, 1u);
  EXPECT_EQ(made.repeated, 1u);
  EXPECT_EQ(made.broken, 1u);
}

/// `ringctl traffic again` of a capture whose two packets are a year apart, if no ring runs.
class ReplayOfAYear : public test::OwnFolder {
 protected:
  ReplayOfAYear() {
    std::ofstream file(path, std::ios::binary);
    capture::PcapngWriter writer{file, {"robot", {}}};
    CaptureInfo info;
    info.from = wire::NodeId{0};
    info.to = wire::NodeId{1};
    const std::chrono::nanoseconds year = std::chrono::hours(24 * 365);
    for (const std::chrono::nanoseconds at : {std::chrono::nanoseconds(0), year})
      writer.packet(at.count(), info, test::view(test::data_packet(0, 1)));
  }

  const std::string path = folder + "/year.pcapng";
};

TEST_F(ReplayOfAYear, IsRefusedIfItWouldLastLonger) {
  const CliRun said = ringctl({"traffic", "again", path, "--speed", "0.001"});
  EXPECT_EQ(said.code, kUsage);
  EXPECT_THAT(said.errors, testing::HasSubstr(path + ": "));
  EXPECT_THAT(said.errors, testing::HasSubstr("--speed"));
  EXPECT_EQ(ringctl({"traffic", "again", path, "--speed", "2"}).code, kNoRing);
}

}  // namespace
}  // namespace limb_ring::ringctl
