// What ringctl says of faults, and of lines that are broken or noisy.
#include <gmock/gmock.h>

#include "support/node_rows.h"
#include "tools/ringctl/fault.h"
#include "tools/ringctl/status_rows.h"

namespace limb_ring::ringctl {
namespace {

using nlohmann::json;
using test::node_rows;

status::Fault drop() {
  status::Fault fault;
  fault.id.text = "body.3";
  fault.name = "drop";
  fault.fault = "drop body -> head packets=5 for=2s";
  fault.age_s = 0.54;
  fault.hits = 2;
  fault.packets_left = 3;
  fault.seconds_left = 1.46;
  return fault;
}

TEST(FaultTable, SaysWhatWhereSinceWhenHowOftenAndWhatIsLeft) {
  status::Fault cut;
  cut.id.text = "knee.1";
  cut.fault = "cut knee -> ankle after=1s";
  cut.waits = true;
  EXPECT_EQ(fault_table({drop(), cut}),
            "id      fault                               since s  struck  left\n"
            "body.3  drop body -> head packets=5 for=2s      0.5  2       3 packets, 1.5 s\n"
            "knee.1  cut knee -> ankle after=1s              0.0  waits   until removed\n");
}

TEST(FaultTable, HasNullInJsonForAFaultWithoutAnEnd) {
  EXPECT_EQ(to_json(std::vector{drop()})[0]["packets_left"], 3);
  EXPECT_TRUE(to_json(std::vector{status::Fault{}})[0]["packets_left"].is_null());
}

/// Nodes 0 to 2, each with the one before it at its input.
std::vector<json> three_nodes() {
  std::vector<json> rows;
  for (int id = 0; id < 3; ++id)
    rows.push_back(
        {{"id", id},
         {"name", "node" + std::to_string(id)},
         {"input", {{"from", (id + 2) % 3}}},
         {"broken_line", nullptr},
         {"faults", json::array()},
         {"counters", json::object()},
         {"lately_damaged", {{"within_s", 10}, {"oldest_s", 0}, {"crc_errors", 0}, {"returns_damaged", 0}}}});
  return rows;
}

/// Of them the first 8 s ago.
void came_damaged(json& row, unsigned crc_errors, unsigned returns_damaged) {
  row["lately_damaged"] = {
      {"within_s", 10}, {"oldest_s", 8.0}, {"crc_errors", crc_errors}, {"returns_damaged", returns_damaged}};
}

TEST(LineReport, IsEmptyIfAllIsWell) { EXPECT_EQ(line_report(node_rows(three_nodes())), ""); }

TEST(LineReport, BelievesTheNodeBehindABreak) {
  std::vector<json> rows = three_nodes();
  for (json& row : rows) row["broken_line"] = {{"before", 0}, {"behind", 1}, {"since_s", 12.0}};
  rows[1]["broken_line"] = {{"before", 0}, {"behind", 1}, {"since_s", 12.31}, {"announced_ms", 21.44}};
  EXPECT_EQ(line_report(node_rows(rows)), "broken line node0 -> node1, 12.3 s ago, announced 0.021 s later\n");
}

TEST(LineReport, SaysNothingOfAnAnnouncementThatTheNodeBehindABreakDoesNotKnow) {
  std::vector<json> rows = three_nodes();
  for (json& row : rows) row["broken_line"] = {{"before", 0}, {"behind", 1}, {"since_s", 12.0}};
  rows[1]["broken_line"]["since_s"] = 12.31;
  EXPECT_EQ(line_report(node_rows(rows)), "broken line node0 -> node1, 12.3 s ago\n");
}

TEST(LineReport, NamesASecondLineThatIsBrokenByTheNextNodeThatIsThere) {
  auto rows = three_nodes();
  for (json& row : rows) row["fold"] = {{"second_input", "up"}};
  EXPECT_EQ(line_report(node_rows(rows)), "");
  rows[1]["fold"]["second_input"] = "down";
  EXPECT_EQ(line_report(node_rows(rows)),
            "broken second line node2 -> node1: the ring can fold back only around node1 -> node2\n");
  rows[2].erase("fold");  // it does not answer
  EXPECT_EQ(line_report(node_rows(rows)),
            "broken second line node0 -> node1: the ring can fold back only around node1 -> node0\n");
}

TEST(LineReport, NamesTheNoisyLineAndNotThoseThatDamagedPacketsPassLater) {
  std::vector<json> rows = three_nodes();
  came_damaged(rows[1], 6, 2);  // four went on, two were its own
  came_damaged(rows[2], 4, 3);
  came_damaged(rows[0], 1, 1);
  EXPECT_EQ(line_report(node_rows(rows)), "noisy line node0 -> node1: 6 packets came in damaged in the last 10 s\n");
}

TEST(LineReport, DoesNotBlameTheLineBehindANodeThatPassesDamageOnAndCountsNone) {
  std::vector<json> rows = three_nodes();
  rows[0].erase("lately_damaged");
  came_damaged(rows[2], 6, 0);
  came_damaged(rows[1], 6, 6);
  EXPECT_EQ(line_report(node_rows(rows)), "noisy line node1 -> node2: 6 packets came in damaged in the last 10 s\n");
  came_damaged(rows[2], 0, 0);
  EXPECT_EQ(line_report(node_rows(rows)),
            "noisy line node2 -> node0 -> node1: 6 packets came in damaged in the last 10 s\n");
}

TEST(LineReport, SaysNothingOfDamageThatIsOver) {
  std::vector<json> rows = three_nodes();
  rows[1]["counters"] = {{"crc_errors", 6}, {"returns_damaged", 6}};
  came_damaged(rows[1], 0, 0);
  EXPECT_EQ(line_report(node_rows(rows)), "");
}

TEST(LineReport, BlamesNoLineForWhatANodeThatWasStartedAgainHadPassedOn) {
  std::vector<json> rows = three_nodes();
  came_damaged(rows[2], 40, 40);
  came_damaged(rows[1], 0, 0);
  rows[1]["uptime_s"] = 1.5;
  EXPECT_EQ(line_report(node_rows(rows)), "");
  rows[1]["uptime_s"] = 8.5;
  EXPECT_EQ(line_report(node_rows(rows)), "noisy line node1 -> node2: 40 packets came in damaged in the last 10 s\n");
}

TEST(LineReport, DoesNotTakeAFewPacketsUnderWayForNoiseOfTheNextLine) {
  std::vector<json> rows = three_nodes();
  came_damaged(rows[1], 47, 1);
  came_damaged(rows[2], 48, 48);
  EXPECT_EQ(line_report(node_rows(rows)), "noisy line node0 -> node1: 47 packets came in damaged in the last 10 s\n");
}

TEST(LineReport, NamesFaultsOnPurpose) {
  std::vector<json> rows = three_nodes();
  rows[2]["faults"].push_back({{"id", 4}, {"fault", "stall node2 -> node0"}});
  EXPECT_EQ(line_report(node_rows(rows)), "fault on purpose node2.4: stall node2 -> node0\n");
}

TEST(LineReport, SaysNothingAboutNodesThatDoNotAnswer) {
  EXPECT_EQ(line_report({down_row({0, "node0"}), down_row({1, "node1"})}), "");
}

}  // namespace
}  // namespace limb_ring::ringctl
