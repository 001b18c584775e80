// What ringctl prints, and how it comes to it.
#include <gmock/gmock.h>

#include <set>
#include <sstream>

#include "support/node_rows.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/clock.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/send.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {
namespace {

using nlohmann::json;
using test::node_row;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

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
  const status::NodeRow row = down_row({12, "left_knee"});
  const json written = to_json(row);
  EXPECT_EQ(written["state"], "down");
  for (const char* member : {"/id", "/name", "/pid", "/cpu/pid", "/cpu/boots", "/cpu/state", "/ring_size",
                             "/round_trip_us/p50", "/round_trip_us/p99", "/round_trip_us/max", "/counters"})
    EXPECT_TRUE(written.contains(json::json_pointer(member))) << member;
  EXPECT_THAT(status_table({row}), HasSubstr("12  left_knee  down"));
}

TEST(StatusTable, ShowsWhatANodeSays) {
  const status::NodeRow row = node_row({{"id", 3},
                                        {"name", "head"},
                                        {"state", "up"},
                                        {"pid", 4711},
                                        {"ring_size", 16},
                                        {"cpu", {{"pid", 4712}, {"boots", 2}, {"state", "running"}}},
                                        {"round_trip_us", {{"p50", 61.24}, {"p99", 90.0}, {"max", 120.0}}}});
  EXPECT_THAT(status_table({row}), HasSubstr("3  head  up       16  running      2    61.2    90.0   120.0\n"));
  StatusStyle style;
  style.pids = true;
  EXPECT_THAT(status_table({row}, style), HasSubstr("120.0  4711     4712\n"));
}

/// As wide as it gets: an open chain of nodes with names as long as allowed, after a slow second.
Rows wide_rows() {
  const json trip{{"p50", 123456.7}, {"p99", 999999.9}, {"max", 1234567.8}};
  Rows rows;
  for (int id = 240; id < 255; ++id)
    rows.push_back(node_row({{"id", id},
                             {"name", "joint_" + std::string(23, 'x') + std::to_string(id)},
                             {"state", "open_chain"},
                             {"ring_size", 255},
                             {"cpu", {{"boots", 12}, {"state", "running"}}},
                             {"round_trip_us", trip}}));
  return rows;
}

TEST(StatusTable, FitsEightyColumnsByShorteningNamesThatStayDistinct) {
  StatusStyle style;
  style.width = 80;
  std::istringstream lines(status_table(wide_rows(), style));
  std::set<std::string> different;
  for (std::string line; std::getline(lines, line); different.insert(line)) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_EQ(different.size(), 16u);
  EXPECT_THAT(*different.rbegin(), HasSubstr("joint_x~"));
}

TEST(StatusTable, ShowsFullNamesInAPipe) { EXPECT_THAT(status_table(wide_rows()), HasSubstr(wide_rows()[0].name)); }

TEST(StatusTable, IsColouredIfANodeOrItsCpuIsNotWell) {
  Rows rows = wide_rows();
  StatusStyle style;
  style.colour = true;
  EXPECT_THAT(status_table(rows, style), HasSubstr("\033[31m240"));
  for (status::NodeRow& row : rows) row.state = "up";
  rows[0].cpu.hung = true;
  EXPECT_THAT(status_table(rows, style), HasSubstr("\033[33m240"));
  EXPECT_THAT(status_table(rows, style), Not(HasSubstr("\033[31m")));
}

TEST(Headline, CountsNodesAndSaysWhereTheRingFolds) {
  Rows rows = wide_rows();
  EXPECT_EQ(headline("robot", rows), "ring robot: 15 of 15 nodes work, open chain");
  for (status::NodeRow& row : rows) row.state = "joining";
  EXPECT_EQ(headline("robot", rows), "ring robot: 0 of 15 nodes up");
  for (status::NodeRow& row : rows) row.state = "folded";
  EXPECT_EQ(headline("robot", rows), "ring robot: 15 of 15 nodes up, folded back around a break");
  rows[0].ring_size = 7;
  EXPECT_EQ(headline("robot", rows), "ring robot: 15 of 15 nodes up, folded back in parts");
}

TEST(Counted, HasAPluralIfItNeedsOne) {
  EXPECT_EQ(app::counted(1, "daemon"), "1 daemon");
  EXPECT_EQ(app::counted(2, "daemon"), "2 daemons");
}

TEST(Wrapped, BreaksLinesBetweenWords) {
  EXPECT_EQ(app::wrapped("one two three\nfour\n", 9), "one two\n    three\nfour\n");
  EXPECT_EQ(app::wrapped("  a_word_that_is_too_long\n", 9), "  a_word_that_is_too_long\n");
}

/// The body, which is the supervisor, and the knee it has found hung.
Rows rows_of_a_hang() {
  status::WatchedCpu knee;
  knee.id = 10;
  knee.name = "left_knee";
  knee.verdict = "hung";
  knee.for_ms = 1240;
  knee.hangs = knee.resets = knee.tries = 1;
  knee.last = "reset 1 of 3 ordered";
  knee.reset_reason = "silent for 640 ms";
  status::WatchedCpu head = knee;
  head.id = 2;
  head.name = "head";
  head.verdict = "alive";
  head.hangs = head.resets = 0;
  Rows rows{down_row({0, "body"}), down_row({2, "head"}), down_row({10, "left_knee"})};
  rows[0].supervisor = status::Supervisor{"auto", {head, knee}};
  return rows;
}

TEST(Supervision, MarksTheHungCpuInItsOwnRow) {
  Rows rows = rows_of_a_hang();
  add_verdicts(rows);
  EXPECT_EQ(rows[0].cpu.verdict, "");
  EXPECT_EQ(rows[1].cpu.verdict, "alive");
  EXPECT_EQ(rows[2].cpu.verdict, "hung");
  EXPECT_THAT(status_table(rows), HasSubstr("hung"));
}

TEST(Supervision, TellsWhatWasDoneAboutIt) {
  EXPECT_EQ(supervision_text(rows_of_a_hang()),
            "supervisor body, policy auto:\n"
            "  left_knee: hung for 1.2 s (reset 1 of 3 ordered); 1 hang, 1 reset by it, 0 confirmed\n");
}

TEST(Supervision, NamesThoseBehindABreakInOneLine) {
  Rows rows = rows_of_a_hang();
  auto& watched = rows[0].supervisor->watched;
  status::WatchedCpu& head = watched[0];
  head.verdict = "unreachable";
  head.last = "no beacon of its node for 500 ms";
  status::WatchedCpu waist = head;
  waist.name = "waist";
  watched.push_back(waist);
  EXPECT_EQ(supervision_text(rows),
            "supervisor body, policy auto:\n"
            "  left_knee: hung for 1.2 s (reset 1 of 3 ordered); 1 hang, 1 reset by it, 0 confirmed\n"
            "  unreachable (no beacon of its node for 500 ms): head, waist\n");
}

TEST(Supervision, SaysNothingIfAllIsWellOrNobodyWatches) {
  Rows rows = rows_of_a_hang();
  rows[0].supervisor->watched.pop_back();
  EXPECT_EQ(supervision_text(rows), "");
  rows[0].supervisor.reset();
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

TEST(ClockOffsets, ABypassedNodeIsNotAHop) {
  const auto offsets = clock_offsets({0, std::nullopt, 10'000}, 0, 20.0, 2);
  EXPECT_FALSE(offsets[1].offset_us.has_value());
  EXPECT_EQ(offsets[2].hops, 1u);
  EXPECT_THAT(*offsets[2].offset_us, DoubleNear(0.0, 1e-9));
}

TEST(LineDelays, OfOneClockAreTheDifferencesOfTheLatches) {
  // Node 1 sends; 10 us to node 2, 15 us from there to node 0, 5 us home.
  const LineDelays delays = line_delays({1'025'000, 1'000'000, 1'010'000}, {"", "", ""}, 1, 30.0);
  ASSERT_EQ(delays.lines.size(), 3u);
  EXPECT_EQ(delays.lines[0].to, 2u);
  EXPECT_THAT(*delays.lines[0].us, DoubleNear(10.0, 1e-9));
  EXPECT_THAT(*delays.lines[1].us, DoubleNear(15.0, 1e-9));
  EXPECT_EQ(delays.lines[2].to, 1u);
  EXPECT_THAT(*delays.lines[2].us, DoubleNear(5.0, 1e-9));
  EXPECT_EQ(delays.between_hosts, 0u);
}

TEST(LineDelays, BetweenHostsOnlyTheSumIsKnownWhateverTheOtherClockSays) {
  // Nodes 0, 1 at one host, 2, 3 at another whose clock is a second ahead; 10 us within a host, 100 and 300 between.
  const LineDelays delays =
      line_delays({0, 10'000, 1'000'110'000, 1'000'120'000}, {"waist", "waist", "head", "head"}, 0, 420.0);
  EXPECT_THAT(*delays.lines[0].us, DoubleNear(10.0, 1e-9));
  EXPECT_FALSE(delays.lines[1].us);
  EXPECT_THAT(*delays.lines[2].us, DoubleNear(10.0, 1e-9));
  EXPECT_FALSE(delays.lines[3].us);
  EXPECT_EQ(delays.between_hosts, 2u);
  EXPECT_THAT(delays.between_hosts_us, DoubleNear(400.0, 1e-9));
}

TEST(LineDelays, BelowZeroAreShownAsZeroAndCountAsUncertaintyOfTheLatches) {
  // Node 2 was not run when the interrupt had passed it: 40 us to it, where home it took 30 us in all.
  const LineDelays delays = line_delays({0, 10'000, 40'000}, {"", "", ""}, 0, 30.0);
  EXPECT_THAT(*delays.lines[1].us, DoubleNear(30.0, 1e-9));
  EXPECT_EQ(*delays.lines[2].us, 0.0);
  EXPECT_THAT(delays.uncertain_us, DoubleNear(10.0, 1e-9));
  EXPECT_EQ(line_delays({0, 10'000}, {"", ""}, 0, 20.0).uncertain_us, 0.0);
}

TEST(LineDelays, LeaveOutANodeThatDidNotLatch) {
  const LineDelays delays = line_delays({0, std::nullopt, 20'000}, {"", "", ""}, 0, 30.0);
  ASSERT_EQ(delays.lines.size(), 2u);
  EXPECT_THAT(*delays.lines[0].us, DoubleNear(20.0, 1e-9));
  EXPECT_EQ(delays.lines[0].to, 2u);
}

Result result(Outcome outcome, std::string reason = {}) {
  Result made;
  made.outcome = outcome;
  made.round_trip = std::chrono::nanoseconds(61'240);
  made.tries = 1;
  made.reason = std::move(reason);
  return made;
}

/// As many sends as have ended, so with nothing outstanding.
Sends ended(std::vector<Result> results) {
  Sends sends;
  sends.asked = sends.sent = results.size();
  sends.results = std::move(results);
  return sends;
}

TEST(Results, OneIsDescribedInWords) {
  EXPECT_EQ(to_text(result(Outcome::delivered)), "delivered in 61.2 us");
  EXPECT_EQ(to_text(result(Outcome::rejected, "queue full")), "rejected in 61.2 us: queue full");
  Result tried_often = result(Outcome::refused);
  tried_often.tries = 22;
  EXPECT_EQ(to_text(tried_often), "refused after 22 tries, the last took 61.2 us");
}

TEST(Results, HaveOneFormInASentenceForEveryOutcome) {
  for (const Outcome outcome : {Outcome::delivered, Outcome::refused, Outcome::no_such_node, Outcome::lost,
                                Outcome::unconfirmed, Outcome::rejected, Outcome::cancelled})
    EXPECT_EQ(ended_text(to_string(outcome), 0, 1, "so"), std::string("ended '") + to_string(outcome) + "': so");
  EXPECT_EQ(ended_text("no such node", 1154.62, 1, ""), "ended 'no such node' after 1154.6 us");
  EXPECT_EQ(ended_text("lost", 0, 4, ""), "ended 'lost' after 4 tries");
  EXPECT_EQ(ended_text("delivered", 61.24, 2, ""), "ended 'delivered' after 2 tries, the last took 61.2 us");
}

TEST(Results, ExitCodeSaysWhetherAllWereDelivered) {
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(report(ended({result(Outcome::delivered)}), false), kDone);
  EXPECT_EQ(report(ended({result(Outcome::delivered), result(Outcome::lost)}), false), kUnknown);
  EXPECT_EQ(report(ended({result(Outcome::lost), result(Outcome::refused)}), false), kNotDone);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr("1 lost"));
}

TEST(Results, SendsThatHaveNotEndedAreCountedAndTheReasonIsThrown) {
  Sends sends = ended({result(Outcome::delivered)});
  sends.asked = sends.sent = 3;
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(report(sends, false), kNotDone);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr("2 not ended"));
  sends.problem = "the daemon has ended";
  ::testing::internal::CaptureStdout();
  EXPECT_THROW(report(sends, false), HostPortError);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr("1 delivered"));
}

TEST(Results, WhatWasNotSentAnyMoreIsCounted) {
  Sends sends = ended({result(Outcome::delivered)});
  sends.asked = 100;
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(report(sends, false), kNotDone);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "1 delivered\ninterrupted, 99 not sent\n");
  sends.problem = "the daemon has ended";
  ::testing::internal::CaptureStdout();
  EXPECT_THROW(report(sends, false), HostPortError);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "1 delivered\n99 not sent\n");
}

TEST(Results, WhatWasUnconfirmedMayHaveArrivedUnlessItWasOutOfReach) {
  Result sent = result(Outcome::unconfirmed);
  sent.why = Reason::open_chain;
  EXPECT_EQ(exit_code({sent}), kUnknown);
  sent.why = Reason::out_of_reach;
  EXPECT_EQ(exit_code({sent}), kNotDone);
}

/// The row of a node whose daemon has counted so many refusals.
status::NodeRow counted(const char* counter, unsigned count, const char* cpu) {
  return node_row({{"cpu", {{"state", cpu}}}, {"counters", {{counter, count}}}});
}

TEST(RefusalCounters, SayWhyIfTheSourceOnlyInfers) {
  const std::vector<ask::Node> nodes{{1, "knee"}};
  const RefusalCounters before(ask::Rows{{1, counted("refused_cpu_absent", 3, "booting")}});
  std::vector<Result> results{result(Outcome::refused, "probably"), result(Outcome::delivered)};
  before.explain(results, nodes, {{1, counted("refused_cpu_absent", 4, "booting")}});
  EXPECT_EQ(results[0].why, Reason::cpu_booting);
  EXPECT_EQ(results[0].reason, "at knee: its CPU is booting (counted there)");
  EXPECT_EQ(results[1].reason, "");
}

TEST(RefusalCounters, SayNothingIfNothingOrTwoThingsWereCounted) {
  const std::vector<ask::Node> nodes{{1, "knee"}, {2, "foot"}};
  const RefusalCounters before(
      ask::Rows{{1, counted("refused_cpu_absent", 3, "absent")}, {2, counted("refused_no_buffer", 0, "running")}});
  std::vector<Result> results{result(Outcome::refused, "probably")};
  before.explain(results, nodes, {{1, counted("refused_cpu_absent", 3, "absent")}});
  EXPECT_EQ(results[0].reason, "probably");
  before.explain(results, nodes,
                 {{1, counted("refused_cpu_absent", 4, "absent")}, {2, counted("refused_no_buffer", 1, "running")}});
  EXPECT_EQ(results[0].reason, "probably");
}

status::NodeRow node(int id, const char* state, bool latched = false) {
  return node_row({{"id", id},
                   {"name", "n" + std::to_string(id)},
                   {"state", state},
                   {"ring_size", 3},
                   {"cpu", {{"state", "running"}, {"stop", {{"latched", latched}}}}}});
}

TEST(Headline, CountsTheNodesThatWork) {
  EXPECT_EQ(headline("r", {node(0, "up"), node(1, "down"), node(2, "up")}), "ring r: 2 of 3 nodes up");
  status::NodeRow chain = node(0, "open_chain");
  chain.broken_line = status::BrokenLine{1, 2, {}, {}};
  EXPECT_EQ(headline("r", {chain, node(1, "open_chain"), node(2, "open_chain")}),
            "ring r: 3 of 3 nodes work, open chain: line n1 -> n2 broken");
  EXPECT_EQ(headline("r", {node(0, "folded"), node(1, "folded"), node(2, "folded")}),
            "ring r: 3 of 3 nodes up, folded back around a break");
}

TEST(Headline, NodesThatAreStoppedAreNamedWithWhatEndsIt) {
  EXPECT_EQ(stop_report({node(0, "up"), node(1, "up")}), "");
  EXPECT_EQ(stop_report({node(0, "up", true), node(1, "up")}), "stopped: n0; 'ringctl resume' ends it\n");
  EXPECT_EQ(stop_report({node(0, "up", true)}), "stopped: all nodes; 'ringctl resume' ends it\n");
  EXPECT_EQ(cpu_word(node(0, "up", true)), "stopped");
  EXPECT_NE(status_colour("up", "stopped"), std::string());
  EXPECT_EQ(cpu_word(node(0, "up")), "running");
}

TEST(Results, JsonHoldsEveryOne) {
  ::testing::internal::CaptureStdout();
  report(ended({result(Outcome::delivered), result(Outcome::refused)}), true);
  const json printed = json::parse(::testing::internal::GetCapturedStdout());
  EXPECT_EQ(printed["sent"], 2);
  EXPECT_EQ(printed["delivered"], 1);
  EXPECT_EQ(printed["results"][1]["outcome"], "refused");
}

}  // namespace
}  // namespace limb_ring::ringctl
