#include "sim/scenario_text.h"
#include "support/node_literal.h"

namespace limb_ring::scenario {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// What is added to four_nodes() begins in line 3.

TEST(LoadScenario, ReadsStepsInTheirOrder) {
  const Scenario scenario = parse_scenario(
      four_nodes(
          "seed: 7\nsteps:\n  - {at: 1ms, do: {kill: [node1, 2]}}\n  - {when: {node: all, is: up}, within: 2us}\n"),
      "t");
  EXPECT_EQ(scenario.seed, 7u);
  ASSERT_EQ(scenario.steps.size(), 2u);
  EXPECT_EQ(std::get<Fault>(scenario.steps[0].action).nodes, (std::vector<NodeId>{1_id, 2_id}));
  EXPECT_EQ(scenario.steps[1].within.sim, std::chrono::microseconds(2));
}

TEST(LoadScenario, ADeadlineMayDifferBetweenSimulationAndLiveRuns) {
  const Scenario scenario =
      parse_scenario(four_nodes("steps: [{when: {node: all, is: up}, within: {sim: 200us, live: 2s}}]\n"), "t");
  EXPECT_EQ(scenario.steps[0].within.sim, std::chrono::microseconds(200));
}

TEST(LoadScenario, LiveRunsHaveMoreTimeIfTheFileGivesOne) {
  const auto within = [](const std::string& time) {
    const std::string step = "{when: {node: all, is: up}, within: " + time + "}";
    return parse_scenario(four_nodes("steps: [" + step + "]\n"), "t").steps[0].within;
  };
  EXPECT_EQ(within("{sim: 200us, live: 2s}").live, std::chrono::seconds(2));
  EXPECT_EQ(within("1s").live, std::chrono::seconds(1) + kLiveGuard);
  EXPECT_EQ(within("{sim: 0s}").live, kLiveGuard);
}

TEST(LoadScenario, ClocksAreOfNodesAndWithinATenth) {
  EXPECT_EQ(parse_scenario(four_nodes("clocks: {node1: 200, node3: -70}\nsteps: [{at: 1ms}]\n"), "t").clocks,
            (std::vector<int>{0, 200, 0, -70}));
  EXPECT_THAT(refusal_of(four_nodes("clocks: {node7: 200}\nsteps: [{at: 1ms}]\n")),
              HasSubstr("'node7' is not a node of the ring"));
  EXPECT_THAT(refusal_of(four_nodes("clocks: {node1: 200000}\nsteps: [{at: 1ms}]\n")), HasSubstr("-100000 to 100000"));
}

TEST(LoadScenario, NamesLineEntryAndWhatIsAllowed) {
  EXPECT_THAT(refusal_of(four_nodes("steps:\n  - {do: {kil: node1}}\n")),
              AllOf(StartsWith("test.yaml:4:11: entry 'steps[0].do.kil': is unknown, did you mean 'kill'?"),
                    HasSubstr("cut, heal, drop, corrupt, truncate, duplicate")));
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {kill: node7}}]\n")), HasSubstr("'node7' is not a node of the ring"));
  EXPECT_THAT(refusal_of(four_nodes("step: []\n")),
              StartsWith("test.yaml:3:1: entry 'step': is unknown, did you mean 'steps'?"));
}

TEST(LoadScenario, TheFileOfARingIsToldWhatItIs) {
  EXPECT_THAT(refusal_of("ring: two\ntimeouts: {}\nnodes: [{id: 0}, {id: 1}]\n"),
              AllOf(HasSubstr("entry 'nodes': this is the file of a ring, not a scenario"),
                    HasSubstr("'ringctl up FILE' for a ring")));
}

TEST(LoadScenario, ExpectationsAreWaitsAndWhatHoldsAlwaysOrNever) {
  const auto expects = [](const std::string& more) { return expects_something(parse_scenario(four_nodes(more), "t")); };
  EXPECT_FALSE(expects("steps: []\n"));
  EXPECT_FALSE(expects("steps: [{at: 1ms, do: {kill: node1}}]\n"));
  EXPECT_TRUE(expects("steps: [{when: {node: all, is: up}, within: 0s}]\n"));
  EXPECT_TRUE(expects("steps: []\nalways: [{node: all, is: up}]\n"));
  EXPECT_TRUE(expects("steps: []\nnever: [{node: all, is: down}]\n"));
}

TEST(LoadScenario, RefusesALineThatTheRingDoesNotHave) {
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {cut: node0 -> node2}}]\n")),
              HasSubstr("to the next: node0 -> node1"));
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {cut: node0}}]\n")), HasSubstr("cut needs a line"));
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {cut: node1 -> node0}}]\n")), HasSubstr("a ring that folds back"));
}

TEST(LoadScenario, SaysHowOptionsOfAFaultAreWritten) {
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {freeze: node2, for: 100ms}}]\n")),
              HasSubstr("entry 'steps[0].do.for': is beside freeze, not in it; allowed: freeze: {nodes: N, for: ...}"));
  EXPECT_THAT(
      refusal_of(four_nodes("steps: [{do: {packets: 1, drop: node1 -> node2}}]\n")),
      HasSubstr("'steps[0].do.packets': is beside drop, not in it; allowed: drop: {line: A -> B, packets: ..."));
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {freeze: node2, packets: 1}}]\n")),
              HasSubstr("is unknown; allowed: "));
  EXPECT_EQ(refusal_of(four_nodes("steps: [{do: {delay: node1 -> node2 delay=1ms}}]\n")), "");
}

TEST(LoadScenario, RefusesANodeThatIsNamedTwice) {
  EXPECT_THAT(refusal_of(four_nodes("absent: [node1, 1]\nsteps: []\n")),
              HasSubstr("entry 'absent[1]': '1' is named twice; allowed: each node once"));
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {kill: [node1, node2, node1]}}]\n")),
              HasSubstr("'node1' is named twice; allowed: each node once"));
}

TEST(LoadScenario, RefusesARingWithoutANode) {
  for (const char* all : {"all", "[0, 1, 2, 3]"})
    EXPECT_THAT(refusal_of(four_nodes(std::string("absent: ") + all + "\nsteps: []\n")),
                HasSubstr("entry 'absent': no node would be left; allowed: at most all nodes but one"));
}

TEST(LoadScenario, RefusesAWaitWithoutALimit) {
  EXPECT_THAT(refusal_of(four_nodes("steps: [{when: {node: all, is: up}}]\n")), HasSubstr("'within' is missing"));
  EXPECT_THAT(refusal_of(four_nodes("steps: [{within: 1s}]\n")), HasSubstr("the step has no when"));
}

TEST(LoadScenario, RefusesTimesThatRunBackwards) {
  EXPECT_THAT(refusal_of(four_nodes("steps: [{at: 2ms}, {at: 1ms}]\n")), HasSubstr("'1ms' is before an earlier step"));
}

TEST(LoadScenario, RefusesConditionsThatSayNothing) {
  EXPECT_THAT(refusal_of(four_nodes("steps: []\nalways: [{node: all}]\n")),
              HasSubstr("does not say what to look for; allowed: is, ring_size"));
  EXPECT_THAT(refusal_of(four_nodes("steps: []\nnever: [{knee: up}]\n")), HasSubstr("this is not a condition"));
  EXPECT_THAT(refusal_of(four_nodes("steps: []\nnever: [{counter: timeouts, of: all, at_most: 2, at_least: 5}]\n")),
              HasSubstr("'2' leaves nothing between at_least and at_most; allowed: at_least up to at_most"));
  EXPECT_THAT(refusal_of(four_nodes("steps: []\nnever: [{ring_size: 3, node: node1, is: down}]\n")),
              HasSubstr("a node that is down has no ring_size; allowed: ring_size beside another state, or alone"));
  EXPECT_THAT(refusal_of(four_nodes("steps: []\nnever: [{is: down, node: living}]\n")),
              HasSubstr("'down' is not a state of a living node; allowed: a state; down of a node, or of all"));
  EXPECT_THAT(refusal_of(four_nodes("steps: []\nalways: [{counter: crc_error, of: all, at_most: 0}]\n")),
              HasSubstr("did you mean 'crc_errors'?"));
}

TEST(LoadScenario, RefusesANameThatNothingIsSentUnder) {
  EXPECT_THAT(refusal_of(four_nodes("steps: []\nalways: [{taken: x, at_most: 0}]\n")),
              HasSubstr("entry 'always[0].taken': 'x' is not a send"));
}

TEST(LoadScenario, RefusesASendOfNoKindOrOfTwo) {
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {send: {name: x, from: 0, to: 1}}}]\n")),
              HasSubstr("one of size, interrupt, input"));
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {send: {name: x, from: 0, size: 8}}}]\n")),
              HasSubstr("'to' is missing"));
}

TEST(LoadScenario, RefusesAnInputThatIsWiredToNothing) {
  EXPECT_THAT(refusal_of(four_nodes("steps: [{do: {send: {name: x, from: 1, input: 3}}}]\n")),
              HasSubstr("entry 'steps[0].do.send.input': '3' is wired to nothing at node 'node1'; allowed: one of the "
                        "`inputs` that the ring's file gives this node"));
}

TEST(LoadScenario, NeedsOneRing) {
  EXPECT_THAT(refusal_of("scenario: x\nsteps: []\n"), HasSubstr("neither ring nor nodes is given"));
  EXPECT_THAT(refusal_of("scenario: x\nnodes: 2\nring: y\nsteps: []\n"), HasSubstr("both given"));
  EXPECT_THAT(refusal_of("scenario: x\nring: none.yaml\nsteps: []\n"),
              HasSubstr("test.yaml:2:7: entry 'ring': 'none.yaml' does not exist"));
}

TEST(LoadScenario, WantsATitleThatCanBePrinted) {
  for (const char* title : {"\"\\e[2J\"", "\"two\\nlines\""})
    EXPECT_THAT(refusal_of("scenario: " + std::string(title) + "\nnodes: 2\nsteps: []\n"),
                HasSubstr("test.yaml:1:11: entry 'scenario': the title has bytes that are not plain text"));
}

}  // namespace
}  // namespace limb_ring::scenario
