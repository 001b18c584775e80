// The run of a story apart from what it is played on: a ring of four nodes that does what the test says, seen every
// 10 ms, and not exact, as a live one.
#include <map>

#include "sim/scenario_text.h"
#include "support/node_literal.h"

namespace limb_ring::scenario {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

class PaperStage final : public Stage {
 public:
  std::map<NodeId, core::Duration> dies;  ///< when
  std::optional<Failure> at_begin, at_action;
  std::optional<core::Duration> breaks;  ///< when
  std::vector<std::string> done;
  core::Duration per_action{0};

  unsigned size() const override { return 4; }
  const std::string& name(NodeId id) const override { return names_[id]; }
  bool alive(NodeId id) const override { return dies.count(id) == 0 || now_ < dies.at(id); }
  core::NodeState state(NodeId) const override { return core::NodeState::up; }
  unsigned ring_size(NodeId) const override { return 4; }
  std::optional<wire::Beacon> heard(NodeId, NodeId) const override { return std::nullopt; }
  std::uint64_t counter(NodeId, const std::string&) const override { return 0; }
  const Tally& tally(const std::string&) const override { return tally_; }
  nanoseconds allowed(const Limit& limit) const override { return limit.live; }

  std::optional<Failure> begin() override { return at_begin; }
  core::Duration now() const override { return now_; }
  bool exact() const override { return false; }
  bool run_until(const std::function<bool()>& held, core::Duration until, const std::string&) override {
    while (!held()) {
      if (now_ >= until) return false;
      now_ += 10ms;
    }
    return true;
  }
  std::optional<Failure> broken() const override {
    return breaks && now_ >= *breaks ? std::optional(Failure{"it runs", "it ended"}) : std::nullopt;
  }
  std::optional<Failure> apply(const Fault& fault) override {
    done.emplace_back(fault::word_of(fault.name).word);
    now_ += per_action;
    return at_action;
  }
  void send(const Send& send) override { done.push_back("send " + send.name); }

 private:
  const std::vector<std::string> names_{"node0", "node1", "node2", "node3"};
  core::Duration now_{0};
  Tally tally_;
};

struct StageRun : testing::Test {
  ScenarioRun play(const std::string& more) {
    return run_scenario(parse_scenario(four_nodes(more), "test.yaml"), 1, stage);
  }
  PaperStage stage;
};

TEST_F(StageRun, DoesTheStepsInOrderAndAtTheirTimes) {
  const ScenarioRun run = play(
      "steps:\n  - {at: 50ms, do: {cut: node0 -> node1}}\n"
      "  - {after: 30ms, do: {send: {name: x, from: node0, to: node1, size: 8}}}\n");
  EXPECT_FALSE(run.unmet);
  EXPECT_THAT(stage.done, ElementsAre("cut", "send x"));
  EXPECT_EQ(run.log.at(1).at, 50ms);
  EXPECT_EQ(run.log.at(2).at, 80ms);
  EXPECT_TRUE(run.live);
}

TEST_F(StageRun, ALimitOfItsOwnCountsOnALiveStage) {
  stage.dies[3_id] = 300ms;
  EXPECT_FALSE(play("steps: [{when: {node: node3, is: down}, within: {sim: 1us, live: 400ms}}]\n").unmet);
}

TEST_F(StageRun, AWaitThatIsNotMetEndsWithItsLimit) {
  const ScenarioRun run = play("steps: [{when: {node: node3, is: down}, within: {sim: 1s, live: 200ms}}]\n");
  ASSERT_TRUE(run.unmet);
  EXPECT_EQ(run.unmet->at, 200ms);
  EXPECT_EQ(run.unmet->expected, "when {node: node3, is: down} within 200ms");
  EXPECT_EQ(run.unmet->seen, "node3 is up, in a ring of 4");
}

TEST_F(StageRun, AStepThatIsLateIsDoneAtOnceIfTimeIsNotExact) {
  stage.per_action = 70ms;
  const ScenarioRun run = play("steps: [{at: 10ms, do: {kill: node3}}, {at: 20ms, do: {start: node3}}]\n");
  EXPECT_FALSE(run.unmet);
  EXPECT_EQ(run.log.at(2).at, 80ms);
}

TEST_F(StageRun, AlwaysIsCheckedOnTheWayToAStep) {
  stage.dies[2_id] = 40ms;
  const ScenarioRun run = play("steps: [{at: 1s, do: {kill: node3}}]\nalways: [{node: all, is: up}]\n");
  ASSERT_TRUE(run.unmet);
  EXPECT_EQ(run.unmet->at, 40ms);
  EXPECT_THAT(stage.done, ElementsAre());
}

TEST_F(StageRun, NeverIsCheckedWhileWaiting) {
  stage.dies[2_id] = 40ms;
  const ScenarioRun run = play(
      "steps: [{when: {node: node3, is: down}, within: 1s}]\n"
      "never: [{node: node2, is: down}]\n");
  ASSERT_TRUE(run.unmet);
  EXPECT_EQ(run.unmet->expected, "never {node: node2, is: down}");
}

TEST_F(StageRun, AnActionThatCannotBeDoneIsTheEnd) {
  stage.at_action = Stage::Failure{"the ring does it", "node3 does not answer"};
  const ScenarioRun run = play("steps: [{do: {kill: node3}}, {do: {start: node3}}]\n");
  ASSERT_TRUE(run.unmet);
  EXPECT_EQ(run.unmet->seen, "node3 does not answer");
  EXPECT_THAT(stage.done, ElementsAre("kill"));
}

TEST_F(StageRun, WhatBreaksWithoutAStepEndsTheRun) {
  stage.breaks = 30ms;
  const ScenarioRun run = play("steps: [{at: 1s}]\n");
  ASSERT_TRUE(run.unmet);
  EXPECT_EQ(run.unmet->seen, "it ended");
}

TEST_F(StageRun, ARingThatDoesNotComeUpIsReported) {
  stage.at_begin = Stage::Failure{"every node joins", "node 3 does not"};
  const ScenarioRun run = play("steps: [{do: {kill: node3}}]\n");
  ASSERT_TRUE(run.unmet);
  EXPECT_THAT(text_of(run), HasSubstr("seen instead: node 3 does not"));
  EXPECT_THAT(stage.done, ElementsAre());
}

// With a beacon each 100 ms by its own clock.
TEST(Stage, ANodeWhoseClockIsFastSaysMoreBeacons) {
  const std::string ten_seconds = "steps:\n  - {at: 10s}\n  - {when: {counter: sent_data, of: node0, ";
  EXPECT_EQ(unmet_of(ten_seconds + "at_most: 106}, within: 0s}\n"), "");
  EXPECT_EQ(unmet_of("clocks: {node0: 100000}\n" + ten_seconds + "at_least: 112}, within: 0s}\n"), "");
}

}  // namespace
}  // namespace limb_ring::scenario
