// Scenarios whose YAML aliases never end, or expand to more than fits into memory.
#include "sim/scenario_text.h"

namespace limb_ring::scenario {
namespace {

using testing::HasSubstr;

TEST(ScenarioAliases, AnActionThatHoldsItselfIsRefused) {
  EXPECT_THAT(refusal_of(four_nodes("steps:\n  - do: {cut: &a [*a]}\n")), HasSubstr("test.yaml:4:19: "));
}

TEST(ScenarioAliases, AnActionOfMoreValuesThanAMachineHoldsIsRefused) {
  std::string action = "[x, x, x, x, x, x, x, x]";
  for (int i = 0; i < 12; ++i) {
    const std::string name = "a" + std::to_string(i);
    action = "[&" + name + " " + action;
    for (int k = 0; k < 7; ++k) action += ", *" + name;
    action += "]";
  }
  EXPECT_THAT(refusal_of(four_nodes("steps:\n  - do: {cut: " + action + "}\n")), HasSubstr("too many values"));
}

TEST(ScenarioAliases, TheWordsOfALongActionAreCutShort) {
  std::string nodes = "0";
  for (int i = 1; i < 200; ++i) nodes += ", " + std::to_string(i);
  const Scenario scenario =
      parse_scenario("scenario: a test\nnodes: 200\nsteps:\n  - do: {kill: [" + nodes + "]}\n", "test.yaml");
  EXPECT_LT(scenario.steps[0].words.size(), 300u);
  EXPECT_THAT(scenario.steps[0].words, HasSubstr(", ...]}"));
}

}  // namespace
}  // namespace limb_ring::scenario
