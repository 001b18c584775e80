// When `ringctl wait` and `fault clear` take a ring for whole, and what they say it lacks.
#include "tools/ringctl/wait.h"

#include <gmock/gmock.h>

#include "support/node_rows.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

using nlohmann::json;
using test::node_row;
using test::node_rows;
using ::testing::Contains;
using ::testing::HasSubstr;

/// Two nodes that fold back, each with a CPU that its ringd starts.
std::vector<json> whole_ring() {
  std::vector<json> rows;
  for (int id = 0; id < 2; ++id)
    rows.push_back({{"id", id},
                    {"name", "node" + std::to_string(id)},
                    {"ring", "robot"},
                    {"state", "up"},
                    {"ring_size", 2},
                    {"cpu", {{"kind", "child"}, {"state", "running"}}},
                    {"fold", {{"second_input", "up"}}}});
  return rows;
}

TEST(Whole, IsARingOfAllItsNodesWithTheirCpus) { EXPECT_EQ(lack_of_whole(node_rows(whole_ring())), ""); }

TEST(Whole, LacksWhatTheFirstIncompleteNodeLacks) {
  const std::vector<std::pair<json, std::string>> lacks{
      {{{"state", "folded"}}, "it is folded"},
      {{{"state", "down"}}, "it is down"},
      {{{"state", "starting"},
        {"warnings", {{{"rule", "a"}, {"text", "too few"}}, {{"rule", "b"}, {"text", "too hot"}}}}},
       "it is starting (too few; too hot)"},
      {{{"state", "unanswered"}, {"unanswered", "too busy"}}, "it has not answered: too busy"},
      {{{"ring_size", 1}}, "it knows a ring of 1 nodes, not 2"},
      {{{"fold", {{"second_input", "down"}}}}, "its second line in is broken"},
      {{{"cpu", {{"kind", "child"}, {"state", "booting"}}}}, "its CPU is booting"},
      {{{"cpu", {{"kind", "child"}, {"state", "running"}, {"hung", true}}}}, "its CPU is hung"}};
  for (const auto& [change, lack] : lacks) {
    std::vector<json> rows = whole_ring();
    rows[1].update(change);
    EXPECT_EQ(lack_of_whole(node_rows(rows)), "node 1 (node1): " + lack);
  }
}

TEST(Whole, IsARingThatWasStopped) {
  std::vector<json> rows = whole_ring();
  for (json& row : rows) row["cpu"]["stop"] = {{"latched", true}};
  EXPECT_EQ(lack_of_whole(node_rows(rows)), "");
}

TEST(Whole, DoesNotNeedACpuThatSomebodyElseStarts) {
  std::vector<json> rows = whole_ring();
  rows[0]["cpu"] = {{"kind", "attached"}, {"state", "absent"}};
  EXPECT_EQ(lack_of_whole(node_rows(rows)), "");
}

TEST(Whole, LacksACpuThatCannotBeStartedAndSaysWhy) {
  std::vector<json> rows = whole_ring();
  rows[0]["cpu"].update({{"state", "failed"}, {"last_exit", "no program 'x'"}});
  EXPECT_EQ(lack_of_whole(node_rows(rows)), "node 0 (node0): its CPU is failed (no program 'x')");
}

TEST(Part, IsInARingOfAtLeastItsNodesOrInAnOpenChain) {
  json row = whole_ring()[0];
  row["ring_size"] = 3;
  EXPECT_EQ(lack_in_part(node_row(row), 2), "");
  EXPECT_EQ(lack_in_part(node_row(row), 4), "it knows a ring of 3 nodes; 4 are on this host");
  row["state"] = "open_chain";
  EXPECT_EQ(lack_in_part(node_row(row), 4), "");
  row["state"] = "joining";
  EXPECT_EQ(lack_in_part(node_row(row), 2), "it is joining");
}

TEST(State, IsThatOfTheNodeOrOfItsCpu) {
  for (const char* node : {"node1", "1"})
    for (const char* state : {"up", "running"}) EXPECT_EQ(lack_of_state(node_rows(whole_ring()), node, state), "");
  EXPECT_EQ(lack_of_state(node_rows(whole_ring()), "node1", "hung"), "node 1 (node1): it is up, its CPU running");
}

TEST(State, IsAnyThatStatusShows) {
  for (const char* word :
       {"duplicate_id", "open_chain", "down", "frozen", "unanswered", "absent", "failed", "hung", "stopped"})
    EXPECT_THAT(state_words(), Contains(word));
}

TEST(State, OfANodeThatIsNotThereIsRefusedWithAGuess) {
  try {
    lack_of_state(node_rows(whole_ring()), "noed1", "up");
    FAIL() << "there is no such node";
  } catch (const UsageError& wrong) {
    EXPECT_THAT(wrong.what(), HasSubstr("did you mean 'node1'? Ring robot has: 0 (node0), 1 (node1)"));
  }
}

}  // namespace
}  // namespace limb_ring::ringctl
