#include "tools/ringctl/top_table.h"

#include <gmock/gmock.h>

#include <cstdint>
#include <sstream>

#include "tools/ringctl/ring_access.h"

namespace limb_ring::ringctl {
namespace {

using nlohmann::json;
using testing::HasSubstr;

status::NodeRow row(std::uint8_t id, std::uint8_t to, std::uint64_t relayed, std::uint64_t bytes,
                    std::uint64_t slices) {
  status::NodeRow row;
  row.id = id;
  row.name = "a_node_with_a_long_name" + std::to_string(id);
  row.state = "up";
  row.pid = 100 + id;
  row.cpu.state = "running";
  row.output = status::Output{"up", to, 1000000};
  row.round_trip_us.p50 = 123.4;
  row.round_trip_us.p99 = 1234.5;
  row.counters = {{"relayed_data", relayed}, {"input_bytes", bytes}, {"input_slices", slices}, {"crc_errors", 2}};
  return row;
}

const StatusSample kBefore{{row(0, 1, 100, 0, 0), row(1, 0, 100, 1000, 10)}, 10.0};
const StatusSample kNow{{row(0, 1, 300, 0, 0), row(1, 0, 100, 51200, 60)}, 12.0};

TEST(TopRows, AreRatesBetweenTwoSamples) {
  const auto rows = top_rows(kBefore, kNow);
  EXPECT_EQ(rows[0]["packets_per_second"], 100.0);
  EXPECT_EQ(rows[1]["packets_per_second"], 0.0);
}

TEST(TopRows, CountDatagramsThatWereLostAmongTheErrors) {
  StatusSample now = kNow;
  now.rows[1].counters["input_datagrams_lost"] = 3;
  now.rows[1].counters["input_losses"] = 1;  // the line's, whose packets are counted
  const auto rows = top_rows(kBefore, now);
  EXPECT_EQ(rows[0]["errors"], 2);
  EXPECT_EQ(rows[1]["errors"], 5);
}

TEST(TopRows, CountBytesAtTheReceivingEndWithoutTheLinksFraming) {
  const auto rows = top_rows(kBefore, kNow);
  EXPECT_EQ(rows[0]["bytes_per_second"], (50200 - 4 * 50) / 2.0);
  EXPECT_EQ(rows[0]["load"], 25000 * 8 / 1e6);
}

TEST(TopRows, SayNothingOfANodeThatHasRestarted) {
  StatusSample now = kNow;
  now.rows[0].pid = 999;
  EXPECT_TRUE(top_rows(kBefore, now)[0]["packets_per_second"].is_null());
}

TEST(TopRows, AreOfTheNodesOwnTimeAndOfOneBoot) {
  StatusSample before = kBefore, now = kNow;
  before.rows[0].uptime_s = 100.0;
  now.rows[0].uptime_s = 140.0;
  EXPECT_EQ(top_rows(before, now)[0]["packets_per_second"], 5.0);
  now.rows[0].uptime_s = 1.0;  // it has started again, in the same process
  EXPECT_TRUE(top_rows(before, now)[0]["packets_per_second"].is_null());
}

TEST(ClockWords, TellTheInstantThePaceAndWhatItIsBehind) {
  json clock{{"now_s", 12.3456}, {"pace", 0.5}, {"paused", false}, {"late_s", 0.001}, {"lost_s", 0.0}};
  EXPECT_EQ(clock_words(clock), "; virtual clock at 12.346 s, pace 0.5");
  clock.update({{"pace", "max"}, {"late_s", 0.25}, {"lost_s", 3.0}});
  EXPECT_EQ(clock_words(clock), "; virtual clock at 12.346 s, pace max, 0.250 s late, 3.000 s lost");
  clock.update({{"paused", true}, {"late_s", 0.0}, {"lost_s", 0.0}, {"allowed_ns", 5}});
  EXPECT_EQ(clock_words(clock), "; virtual clock stands at 12.346 s, pace max, following another");
  EXPECT_EQ(clock_words(json()), "") << "the machine's";
}

TEST(TopTable, ShowsTheLoadOfALineInPercent) {
  EXPECT_THAT(top_table("robot", top_rows(kBefore, kNow)), HasSubstr(" 20% "));
}

TEST(TopTable, FitsEightyColumnsAndTheLinesThereAre) {
  std::vector<json> rows = top_rows(kBefore, kNow);
  rows[0]["bytes_per_second"] = 123456789012.0;
  while (rows.size() < 16) rows.push_back(rows[0]);
  std::istringstream all(top_table("robot", rows, {24})), cut(top_table("robot", rows, {10}));
  std::size_t lines = 0;
  for (std::string line; std::getline(all, line); ++lines) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_EQ(lines, 18u);
  std::string last;
  for (lines = 0; std::getline(cut, last);) ++lines;
  EXPECT_LE(lines, 10u);
  EXPECT_THAT(top_table("robot", rows, {10}), HasSubstr("more nodes"));
}

TEST(TopTable, AWideHeadingIsWrappedAndCountsAsLines) {
  std::vector<json> rows = top_rows(kBefore, kNow);
  while (rows.size() < 16) rows.push_back(rows[0]);
  const std::string name = std::string(32, 'x');
  std::istringstream table(top_table("ring robot: open chain: line " + name + " -> " + name + " broken", rows, {10}));
  std::size_t lines = 0;
  for (std::string line; std::getline(table, line); ++lines) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_LE(lines, 10u);
}

TEST(TopTable, ShowsBytesAlsoOfALineThatHasNoRate) {
  StatusSample before = kBefore, now = kNow;
  for (StatusSample* sample : {&before, &now}) sample->rows[0].output->rate_bit_s.reset();
  EXPECT_THAT(top_table("robot", top_rows(before, now)), HasSubstr("     25    -"));
}

TEST(TopTable, MarksWhatHasChangedIfThereAreColours) {
  StatusSample now = kNow;
  now.rows[1].state = "joining";
  now.rows[1].counters["timeouts"] = 3;
  const auto rows = top_rows(kBefore, now);
  EXPECT_EQ(rows[1]["changed"], json({"state", "errors"}));
  TopStyle style;
  style.colour = true;
  EXPECT_THAT(top_table("robot", rows, style), HasSubstr("\033[7mjoining   \033[0m"));
  style.colour = false;
  EXPECT_THAT(top_table("robot", rows, style), testing::Not(HasSubstr("\033")));
}

TEST(TopTable, CallsACpuWhatStatusCallsIt) {
  StatusSample now = kNow;
  now.rows[0].cpu.hung = true;
  now.rows[1].cpu.verdict = "hung";
  const auto rows = top_rows(kBefore, now);
  EXPECT_EQ(rows[0]["cpu"], "hung");
  EXPECT_EQ(rows[1]["cpu"], "hung");
}

TEST(TopTable, ListsFaultsBelowIfThereIsRoom) {
  const auto rows = top_rows(kBefore, kNow);
  const std::string report = "broken line a -> b\nnoisy line b -> c\n";
  EXPECT_THAT(top_table("robot", rows, {24}, report), HasSubstr("noisy line"));
  const std::string little = top_table("robot", rows, {5}, report);
  EXPECT_THAT(little, HasSubstr("broken line"));
  EXPECT_THAT(little, testing::Not(HasSubstr("noisy line")));
}

}  // namespace
}  // namespace limb_ring::ringctl
