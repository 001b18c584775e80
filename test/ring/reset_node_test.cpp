// What the other daemons know of a reset that could not be confirmed: node 12 (knee) of a ring of four.
#include "ring/reset_node.h"

#include <gmock/gmock.h>

#include "support/node_rows.h"

namespace limb_ring::ask {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

ResetQuery query() {
  ResetQuery query;
  query.nodes = {{0, "body"}, {11, "hip"}, {12, "knee"}, {13, "foot"}};
  query.target = 12;
  query.from = 0;
  return query;
}

using status::NodeRow;
using test::node_row;

NodeRow heard_by(int id, unsigned boots, int age_ms) {
  return node_row({{"id", id},
                   {"state", "open_chain"},
                   {"cpu", {{"boots", 1}}},
                   {"broken_line", {{"before", 13}, {"behind", 0}}},
                   {"heard", {{{"id", 12}, {"cpu_boots", boots}, {"age_ms", age_ms}}}}});
}

NodeRow own_row(unsigned boots) { return node_row({{"id", 12}, {"cpu", {{"boots", boots}}}}); }

const json kUnknown{{"success", false}, {"effect", "unknown"}, {"message", "sent"}};

TEST(ResetSeen, ByTheBeaconAtAnotherNode) {
  const json answer = judged(kUnknown, query(), {{13, heard_by(13, 1, 20)}}, {{13, heard_by(13, 2, 20)}});
  EXPECT_EQ(answer["success"], true);
  EXPECT_EQ(answer["effect"], "seen");
  EXPECT_EQ(answer["message"], "done, seen by its beacon at foot: the CPU has booted again");
  EXPECT_EQ(answer["boots"], 2);
}

TEST(ResetSeen, ByItsOwnDaemon) {
  EXPECT_THAT(judged(kUnknown, query(), {{12, own_row(1)}}, {{12, own_row(2)}})["message"].get<std::string>(),
              HasSubstr("seen by its own daemon"));
}

TEST(ResetSeen, NotByAnOldBeaconNorBySameBoots) {
  for (const NodeRow& row : {heard_by(13, 2, 5000), heard_by(13, 1, 20)}) {
    const json answer = judged(kUnknown, query(), {{13, heard_by(13, 1, 20)}}, {{13, row}});
    EXPECT_EQ(answer["effect"], "unknown");
    EXPECT_THAT(answer["message"].get<std::string>(), HasSubstr("body reaches all others, foot hears all others"));
  }
}

TEST(ResetSeen, NotAtTheFirstNodeOfAnOpenChainButSaysWhatElseResetsIt) {
  ResetQuery first = query();
  first.target = 0;
  const Rows rows{{13, heard_by(13, 1, 20)}};
  EXPECT_THAT(judged(kUnknown, first, rows, rows)["message"].get<std::string>(),
              AllOf(HasSubstr("nothing reaches the first node of an open chain"),
                    HasSubstr("'ringctl fault reset body'"), Not(HasSubstr("reaches all others"))));
}

TEST(Reset, OfANodeWithoutCpuIsKnownByItsRowOrItsBeacon) {
  const auto own = [](const char* state) { return node_row({{"id", 12}, {"cpu", {{"state", state}}}}); };
  NodeRow heard = heard_by(13, 1, 20);
  heard.heard[0].beacon.cpu_state = wire::CpuState::running;
  EXPECT_TRUE(has_no_cpu({{12, own("none")}}, 12));
  EXPECT_FALSE(has_no_cpu({{12, own("absent")}}, 12));
  EXPECT_FALSE(has_no_cpu({{13, heard}}, 12));
  heard.heard[0].beacon.cpu_state = wire::CpuState::none;
  EXPECT_TRUE(has_no_cpu({{13, heard}}, 12));
}

TEST(ResetSeen, AroundAFoldNoNodeIsSaidToReachAll) {
  NodeRow folded = heard_by(13, 1, 20);
  folded.state = "folded";
  const std::string message = judged(kUnknown, query(), {{13, folded}}, {{13, folded}})["message"];
  EXPECT_THAT(message, HasSubstr("the ring has folded: if it is in two parts"));
  EXPECT_THAT(message, Not(HasSubstr("reaches all others")));
}

TEST(ResetSeen, NotByOneThatWasNotAskedBefore) {
  EXPECT_EQ(judged(kUnknown, query(), {}, {{12, own_row(2)}})["effect"], "unknown");
}

TEST(ResetSeen, InAnOpenChainTheNodeBehindTheBreakSendsUnlessAnotherWasNamed) {
  ResetQuery free = query();
  free.from = 13;
  const Rows rows{{0, heard_by(0, 1, 20)}};
  EXPECT_EQ(best_sender(rows, free), 13);  // it was named
  free.from_is_free = true;
  EXPECT_EQ(best_sender(rows, free), 0);
  free.target = 0;
  EXPECT_EQ(best_sender(rows, free), 13);  // nothing reaches the first of a chain
  EXPECT_EQ(best_sender({}, free), 13);
}

}  // namespace
}  // namespace limb_ring::ask
