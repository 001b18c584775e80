#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "comparison/report.h"

namespace limb_ring::comparison {
namespace {

using study::Comparison;
using study::ComparisonOptions;
using testing::HasSubstr;

/// Two methods, the second slow and saturated, with a point of each series.
Comparison example() {
  Comparison out;
  study::Figures fast, slow;
  fast.random_load = study::Spread{std::chrono::nanoseconds(1500), std::chrono::nanoseconds(500)};
  slow.alone.worst = std::chrono::milliseconds(20);
  slow.efficiency = 0.25;
  out.methods = {{{"fast", false, 1'000'000'000}, fast}, {{"slow", true, 5'000'000}, slow}};
  out.against_load = {{{"fast", false, 1'000'000'000}, 0.1, 0.1}};
  out.against_nodes = {{{"slow", true, 5'000'000}, 16, {std::chrono::microseconds(3), std::chrono::microseconds(2)}}};
  return out;
}

ComparisonOptions options() {
  ComparisonOptions out;
  out.seed = 42;
  out.loads = {0.1};
  out.nodes = {16};
  return out;
}

TEST(ComparisonReport, TextNamesTheSeedAndFitsInto100Columns) {
  std::istringstream text(format_comparison(example(), options(), app::Format::text));
  std::string line;
  std::getline(text, line);
  EXPECT_THAT(line, HasSubstr("seed 42"));
  while (std::getline(text, line)) EXPECT_LE(line.size(), 100u) << line;
}

// 16 (T + d) with T = 4.192 us, d = 0.512 us, and 15 of it.
TEST(ComparisonReport, TextStatesTheRingsBound) {
  const std::string text = format_comparison(example(), options(), app::Format::text);
  EXPECT_THAT(text, HasSubstr("70.56 us"));
  EXPECT_THAT(text, HasSubstr("75.26 us"));
}

TEST(ComparisonReport, JsonHasTheOptionsAndEverySeries) {
  const auto json = app::Row::parse(format_comparison(example(), options(), app::Format::json));
  EXPECT_EQ(json["seed"], 42);
  EXPECT_EQ(json["methods"][0]["random_load_worst_us"], 1.5);
  EXPECT_TRUE(json["methods"][1]["random_load_worst_us"].is_null());
  EXPECT_EQ(json["methods"][1]["rate_mbit_s"], 5);
  EXPECT_EQ(json["efficiency_against_load"][0]["delivered"], 0.1);
  EXPECT_EQ(json["latency_against_nodes"][0]["nodes"], 16);
}

TEST(ComparisonReport, CsvHasOneValuePerRow) {
  const std::string csv = format_comparison(example(), options(), app::Format::csv);
  EXPECT_THAT(csv, testing::StartsWith("seed,method,own_rate,rate_mbit_s,nodes,offered,quantity,value\n"));
  EXPECT_THAT(csv, HasSubstr("42,slow,true,5,16,,alone_worst_us,20000\n"));
  EXPECT_THAT(csv, HasSubstr("42,fast,false,1000,16,0.1,delivered,0.1\n"));
}

}  // namespace
}  // namespace limb_ring::comparison
