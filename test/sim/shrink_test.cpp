// `ringctl scenario shrink`: the smallest scenario that misses the same expectation.
#include "sim/scenario_shrink.h"

#include "sim/scenario_text.h"
#include "support/own_folder.h"
#include "support/thrown.h"

namespace limb_ring::scenario {
namespace {

using testing::HasSubstr;
using testing::Not;

class Shrink : public test::OwnFolder {
 protected:
  std::optional<Shrunk> shrunk(const std::string& text) {
    request_.path = write("night.yaml", text);
    return shrink(request_);
  }

  ShrinkRequest request_;
};

// Node 2 is killed among much else, and is expected to be there.
const char* const kNight = R"(scenario: a long night
nodes: 8
rate: 100Mbit/s
steps:
  - {at: 10ms, do: {send: {name: chatter, from: [node0, node3, node5], to: node6, size: 512, every: 1ms, count: 30}}}
  - {at: 12ms, do: {drop: node4 -> node5 packets=3}}
  - {at: 20ms, do: {send: {name: tick, from: node1, to: node3, size: 100, count: 9}}}
  - {at: 25ms, do: {freeze: node7 for=5ms}}
  - {at: 30ms, do: {kill: [node4, node2, node6]}}
  - {at: 60ms, do: {start: [node4, node6]}}
  - {at: 90ms, do: {corrupt: node0 -> node1 packets=1}}
  - {at: 300ms}
always:
  - {counter: duplicate_id_signs, of: all, at_most: 0}
never:
  - {node: node2, is: down}
)";

TEST_F(Shrink, KeepsTheStepsThatMakeTheExpectationFail) {
  const auto small = shrunk(kNight);
  ASSERT_TRUE(small);
  EXPECT_EQ(small->before.faults, 5u);
  EXPECT_EQ(small->before.sends, 99u);
  EXPECT_EQ(small->after.faults, 1u);
  EXPECT_EQ(small->after.sends, 0u);
  EXPECT_EQ(small->run.unmet->expected, "never {node: node2, is: down}");
  EXPECT_THAT(small->text, HasSubstr("kill: [node2]"));
  for (const char* gone : {"chatter", "always", "rate", "start"})
    EXPECT_THAT(small->text, Not(HasSubstr(gone))) << gone;
}

TEST_F(Shrink, EndsAfterItsLimitOfRunsWithWhatItHas) {
  request_.most_runs = 3;
  const auto smaller = shrunk(kNight);
  ASSERT_TRUE(smaller);
  EXPECT_EQ(smaller->runs, 3u);
  EXPECT_TRUE(smaller->stopped);
  EXPECT_THAT(smaller->text, Not(HasSubstr("as small as it could be")));
  const Scenario scenario = parse_scenario(smaller->text, "smaller.yaml");
  EXPECT_TRUE(run_scenario(scenario, scenario.seed).unmet);
  request_.most_runs = kMostShrinkingRuns;
  EXPECT_FALSE(shrunk(kNight)->stopped);
}

TEST_F(Shrink, WhatRemainsIsAScenarioThatFailsAgain) {
  const auto small = shrunk(kNight);
  ASSERT_TRUE(small);
  const Scenario scenario = parse_scenario(small->text, "small.yaml");
  EXPECT_TRUE(expects_something(scenario));
  for (int i = 0; i < 100; ++i) {
    const ScenarioRun run = run_scenario(scenario, scenario.seed);
    ASSERT_TRUE(run.unmet);
    EXPECT_EQ(run.unmet->expected, small->run.unmet->expected);
  }
}

TEST_F(Shrink, KeepsASendThatIsNeededAndItsCount) {
  const auto small = shrunk(R"(scenario: too many
nodes: 4
steps:
  - {at: 5ms, do: {kill: node3}}
  - {at: 10ms, do: {send: {name: x, from: [node0, node1], to: node2, size: 512, count: 16}}}
  - {after: 20ms}
never:
  - {counter: received_data, of: node2, at_least: 3}
)");
  ASSERT_TRUE(small);
  EXPECT_EQ(small->after.faults, 0u);
  EXPECT_GE(small->after.sends, 3u);
  EXPECT_LE(small->after.sends, 4u);
}

// Without the cut it would be missed as well, and for another reason.
TEST_F(Shrink, KeepsTheCauseOfWhatComesTooLate) {
  const auto small = shrunk(R"(scenario: an impatient one
nodes: 4
steps:
  - {at: 5ms, do: {drop: node3 -> node0 packets=1}}
  - {at: 10ms, do: {cut: node1 -> node2}}
  - {when: {located: node1 -> node2}, within: 1ms}
)");
  ASSERT_TRUE(small);
  EXPECT_EQ(small->after.faults, 1u);
  EXPECT_THAT(small->text, HasSubstr("cut: node1 -> node2"));
}

// What it misses is not an expectation of the file, so every one of those could go.
TEST_F(Shrink, StillExpectsSomething) {
  const auto small = shrunk(R"(scenario: a step in the past
nodes: 4
steps: [{after: 50ms}, {at: 10ms}]
always: [{node: all, is: up}]
)");
  ASSERT_TRUE(small);
  EXPECT_EQ(small->run.unmet->expected, "a step that is in time");
  EXPECT_TRUE(expects_something(parse_scenario(small->text, "small.yaml"))) << small->text;
}

TEST_F(Shrink, ItsSeedIsInIt) {
  request_.seed = 77;
  const auto small = shrunk(kNight);
  ASSERT_TRUE(small);
  EXPECT_THAT(small->text, HasSubstr("seed: 77"));
}

TEST_F(Shrink, AScenarioThatPassesHasNothingToShrink) {
  EXPECT_FALSE(shrunk("scenario: a test\nnodes: 4\nsteps: [{at: 1ms}]\nalways: [{node: all, is: up}]\n"));
}

TEST_F(Shrink, AWrongFileIsRefusedAsByARun) {
  EXPECT_THAT(test::thrown<config::ConfigError>([&] { shrunk("scenario: a test\nnodes: 1\nsteps: []\n"); }),
              HasSubstr("night.yaml:2:8"));
}

TEST_F(Shrink, NamesItsRingsFileAsSeenFromWhereItIsToLie) {
  write("ring.yaml", "ring: three\nnodes: [{id: 0}, {id: 1}, {id: 2}]\n");
  request_.beside = folder + "/small";
  const auto small = shrunk(R"(scenario: a dead node
ring: ring.yaml
steps: [{at: 1ms, do: {kill: node1}}, {at: 2ms}]
never: [{node: node1, is: down}]
)");
  ASSERT_TRUE(small);
  EXPECT_THAT(small->text, HasSubstr("ring: ../ring.yaml"));
}

TEST(ScenarioSize, InWordsHasASingularAndAPlural) {
  EXPECT_EQ(in_words(ScenarioSize{1, 1}), "1 fault and 1 send");
  EXPECT_EQ(in_words(ScenarioSize{0, 40}), "0 faults and 40 sends");
}

TEST_F(Shrink, TellsOfEachRun) {
  std::size_t told = 0;
  request_.tell = [&told](std::size_t runs) { told = runs; };
  const auto small = shrunk(kNight);
  ASSERT_TRUE(small);
  EXPECT_EQ(told, small->runs);
}

}  // namespace
}  // namespace limb_ring::scenario
