// Goals: situations in which a ring has to be seen, counted by an observer that changes nothing.
#include "sim/goals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "sim/scenario_text.h"

namespace limb_ring::scenario {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

TEST(Goals, HaveNamesOfTheirOwnAndSaySomething) {
  std::set<std::string> names, sentences;
  for (const sim::Goal& goal : sim::goals()) {
    names.insert(goal.name);
    sentences.insert(goal.sentence);
    EXPECT_EQ(std::string(goal.name).find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string::npos) << goal.name;
    EXPECT_NE(goal.strikes[0], sim::Strike::none) << goal.name << " cannot be sought";
  }
  EXPECT_EQ(names.size(), sim::goals().size());
  EXPECT_EQ(sentences.size(), sim::goals().size());
  EXPECT_GE(names.size(), 60u);
}

/// A story of the soak's world, of four nodes at 1 Gbit/s: a lap takes at most 19.4 us.
std::string unmet_goal(const std::string& goal, const std::string& steps, const std::string& head = "") {
  return unmet_of("world: soak\n" + head + "sometimes: [" + goal + "]\nsteps:\n" + steps);
}
std::string step(const std::string& time, const std::string& what) {
  return "  - {at: " + time + ", do: {" + what + "}}\n";
}
const char* const kGoalSend = "send: {name: one, from: node0, to: node2, size: 100}";
const char* const kGoalFoldBack = "redundancy: foldback\n";

struct GoalCase {
  const char* goal;
  std::string met, not_met;
  const char* head = "";
};

struct EachGoal : testing::TestWithParam<GoalCase> {};

TEST_P(EachGoal, IsMetByItsStoryAndNotByOneThatIsNearlyTheSame) {
  const GoalCase& of = GetParam();
  EXPECT_EQ(unmet_goal(of.goal, of.met, of.head), "");
  EXPECT_THAT(unmet_goal(of.goal, of.not_met, of.head),
              AllOf(HasSubstr(std::string("sometimes ") + of.goal + ": "), HasSubstr("it did not happen")));
}

const std::string kGoalCut = step("60us", "wire: {cut: node0 -> node1}");
const std::string kGoalFold = step("1ms", "cable: {cut: node0 -> node1}");
const std::string kGoalLostSend = step("50us", "slice: {lost: node0 -> node1}") + step("50us", kGoalSend);
INSTANTIATE_TEST_SUITE_P(
    Each, EachGoal,
    testing::Values(
        GoalCase{"breaks_in_a_lap", kGoalCut + step("70us", "wire: {cut: node2 -> node3}"),
                 kGoalCut + step("90us", "wire: {cut: node2 -> node3}")},
        GoalCase{"mended_within_a_lap", kGoalCut + step("70us", "wire: {mend: node0 -> node1}"),
                 kGoalCut + step("90us", "wire: {mend: node0 -> node1}")},
        GoalCase{"cut_off", kGoalCut + step("2ms", "wire: {cut: node1 -> node2}"),
                 kGoalCut + step("2ms", "wire: {cut: node2 -> node3}")},
        GoalCase{"starts_in_a_lap", step("2ms", "power_cycle: node1") + step("2010us", "power_cycle: node3"),
                 step("2ms", "power_cycle: node1") + step("2030us", "power_cycle: node3")},
        GoalCase{"thaw_after_a_start",
                 step("2ms", "freeze: node1") + step("3ms", "power_cycle: node3") + step("4ms", "thaw: node1"),
                 step("2ms", "freeze: node1") + step("4ms", "thaw: node1") + step("5ms", "power_cycle: node3")},
        GoalCase{"retry_meets_a_reset_cpu", kGoalLostSend + step("52us", "reset: node2"),
                 kGoalLostSend + step("52us", "reset: node3")},
        GoalCase{"two_breaks", kGoalCut + step("2ms", "wire: {cut: node2 -> node3}"),
                 kGoalCut + step("1ms", "wire: {mend: node0 -> node1}") + step("2ms", "wire: {cut: node2 -> node3}")},
        GoalCase{"fold_node_killed", kGoalFold + step("5ms", "kill: node0"), kGoalFold + step("5ms", "kill: node2"),
                 kGoalFoldBack},
        GoalCase{"home_on_the_second_line", kGoalFold + step("5ms", kGoalSend), step("5ms", kGoalSend), kGoalFoldBack}),
    [](const auto& made) { return std::string(made.param.goal); });

TEST(Goals, AreCountedInTheReport) {
  const ScenarioRun run =
      run_of("world: soak\nsometimes: [starts_in_a_lap]\nsteps:\n" + step("2ms", "power_cycle: [node1, node3]") +
             step("3ms", "power_cycle: node1") + step("3010us", "power_cycle: node2"));
  EXPECT_EQ(run.log.back().what.words, "sometimes starts_in_a_lap: two nodes start within one lap: 1 time");
}

TEST(Goals, AreNamedWithWhatWasMeantIfTheyAreUnknown) {
  EXPECT_THAT(refusal_of(four_nodes("sometimes: [cut_of]\nsteps: [{at: 1ms}]\n")),
              AllOf(HasSubstr("test.yaml:3:13: entry 'sometimes[0]': 'cut_of' is not a goal, did you mean 'cut_off'?"),
                    HasSubstr("ring_sim soak --goals")));
}

TEST(Goals, AreSomethingToExpectAndVirtualAlone) {
  const Scenario scenario = parse_scenario(four_nodes("sometimes: [cut_off]\nsteps: [{at: 1ms}]\n"), "t");
  EXPECT_TRUE(expects_something(scenario));
  EXPECT_THAT(only_virtual(scenario, ""), Contains(HasSubstr("sometimes: live, nobody sees every packet")));
}

}  // namespace
}  // namespace limb_ring::scenario
