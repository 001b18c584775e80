// What ringctl prints, and how it comes to it.
#include <gmock/gmock.h>

#include "app/ringctl/clock_offsets.h"
#include "app/ringctl/hex.h"
#include "app/ringctl/problems.h"
#include "app/ringctl/results.h"
#include "app/ringctl/status_table.h"
#include "app/ringctl/supervision.h"
#include "app/common/text_table.h"

namespace limb_ring::ringctl {
namespace {

using nlohmann::json;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(TextTable, AlignsTextLeftAndNumbersRight) {
  EXPECT_EQ(app::text_table({{"name", "us"}, {"a", "1.5"}, {"longer", "-"}, {"b", "10.0"}}),
            "name      us\n"
            "a        1.5\n"
            "longer     -\n"
            "b       10.0\n");
}

TEST(Hex, TakesDigitsWithAndWithoutSeparators) {
  EXPECT_THAT(parse_hex("00fF10"), ElementsAre(0x00, 0xff, 0x10));
  EXPECT_THAT(parse_hex("0x01:02 03"), ElementsAre(1, 2, 3));
  EXPECT_THROW(parse_hex("123"), UsageError);
}

TEST(StatusTable, ShowsADaemonThatDoesNotAnswerAsDown) {
  const json row = down_row({12, "left_knee"});
  EXPECT_EQ(row["state"], "down");
  for (const char* member : {"/id", "/name", "/pid", "/cpu/pid", "/cpu/boots", "/cpu/state",
                             "/ring_size", "/round_trip_us/p50", "/round_trip_us/p99",
                             "/round_trip_us/max", "/counters"})
    EXPECT_TRUE(row.contains(json::json_pointer(member))) << member;
  EXPECT_THAT(status_table({row}), HasSubstr("12  left_knee  down"));
}

TEST(StatusTable, ShowsWhatANodeSays) {
  const json row{{"id", 3},
                 {"name", "head"},
                 {"state", "up"},
                 {"pid", 4711},
                 {"ring_size", 16},
                 {"cpu", {{"pid", 4712}, {"boots", 2}, {"state", "running"}}},
                 {"round_trip_us", {{"p50", 61.24}, {"p99", 90.0}, {"max", 120.0}}}};
  EXPECT_THAT(status_table({row}), HasSubstr("3  head  up     4711    16    61.2    90.0   120.0  "
                                             "running     4712      2"));
}

/// The body, which is the supervisor, and the knee it has found hung.
std::vector<json> rows_of_a_hang() {
  const json knee{{"id", 10},      {"name", "left_knee"}, {"verdict", "hung"}, {"for_ms", 1240},
                  {"hangs", 1},    {"resets", 1},         {"confirmed", 0},    {"tries", 1},
                  {"given_up", false}, {"last", "reset 1 of 3 ordered"}, {"reset_reason", "silent for 640 ms"}};
  json head = knee;
  head.update({{"id", 2}, {"name", "head"}, {"verdict", "alive"}, {"hangs", 0}, {"resets", 0}});
  json body = down_row({0, "body"});
  body["supervisor"] = {{"policy", "auto"}, {"watched", {head, knee}}};
  return {body, down_row({2, "head"}), down_row({10, "left_knee"})};
}

TEST(Supervision, MarksTheHungCpuInItsOwnRow) {
  std::vector<json> rows = rows_of_a_hang();
  add_verdicts(rows);
  EXPECT_FALSE(rows[0]["cpu"].contains("verdict"));
  EXPECT_EQ(rows[1]["cpu"]["verdict"], "alive");
  EXPECT_EQ(rows[2]["cpu"]["verdict"], "hung");
  EXPECT_THAT(status_table(rows), HasSubstr("hung"));
}

TEST(Supervision, TellsWhatWasDoneAboutIt) {
  EXPECT_EQ(supervision_text(rows_of_a_hang()),
            "supervisor body, policy auto:\n"
            "  left_knee: hung for 1.2 s (reset 1 of 3 ordered); hung 1, resets 1, confirmed 0\n");
}

TEST(Supervision, SaysNothingWhereAllIsWellOrNobodyWatches) {
  std::vector<json> rows = rows_of_a_hang();
  rows[0]["supervisor"]["watched"].erase(1);
  EXPECT_EQ(supervision_text(rows), "");
  rows[0].erase("supervisor");
  add_verdicts(rows);
  EXPECT_EQ(supervision_text(rows), "");
}

TEST(ClockOffsets, TakeTheWayOfTheInterruptIntoAccount) {
  // 3 nodes, 10 us a hop; node 0 (the last to hear of it from node 1) is 5 us ahead.
  const auto offsets = clock_offsets({1'025'000, 1'000'000, 1'010'000}, 1, 30.0, 3);
  EXPECT_EQ(offsets[1].hops, 0u);
  EXPECT_EQ(offsets[2].hops, 1u);
  EXPECT_EQ(offsets[0].hops, 2u);
  EXPECT_THAT(*offsets[1].offset_us, DoubleNear(0.0, 1e-9));
  EXPECT_THAT(*offsets[2].offset_us, DoubleNear(0.0, 1e-9));
  EXPECT_THAT(*offsets[0].offset_us, DoubleNear(5.0, 1e-9));
}

TEST(ClockOffsets, NodeThatIsBypassedIsNoHop) {
  const auto offsets = clock_offsets({0, std::nullopt, 10'000}, 0, 20.0, 2);
  EXPECT_FALSE(offsets[1].offset_us.has_value());
  EXPECT_EQ(offsets[2].hops, 1u);
  EXPECT_THAT(*offsets[2].offset_us, DoubleNear(0.0, 1e-9));
}

Result result(Outcome outcome, std::string reason = {}) {
  Result made;
  made.outcome = outcome;
  made.round_trip = std::chrono::nanoseconds(61'240);
  made.tries = 1;
  made.reason = std::move(reason);
  return made;
}

TEST(Results, OneIsToldInWords) {
  EXPECT_EQ(to_text(result(Outcome::delivered)), "delivered in 61.2 us");
  EXPECT_THAT(to_text(result(Outcome::rejected, "queue full")), HasSubstr("rejected: queue full"));
}

TEST(Results, ExitCodeSaysWhetherAllWereDelivered) {
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(report({result(Outcome::delivered)}, false), kDone);
  EXPECT_EQ(report({result(Outcome::delivered), result(Outcome::lost)}, false), kNotDone);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr("1 lost"));
}

TEST(Results, JsonHoldsEveryOne) {
  ::testing::internal::CaptureStdout();
  report({result(Outcome::delivered), result(Outcome::refused)}, true);
  const json printed = json::parse(::testing::internal::GetCapturedStdout());
  EXPECT_EQ(printed["sent"], 2);
  EXPECT_EQ(printed["delivered"], 1);
  EXPECT_EQ(printed["results"][1]["outcome"], "refused");
}

}  // namespace
}  // namespace limb_ring::ringctl
