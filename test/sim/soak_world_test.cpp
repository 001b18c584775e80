// The world of `ring_sim soak` in a scenario: what only it has, and how it ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/scenario_report.h"
#include "sim/scenario_shrink.h"
#include "sim/scenario_text.h"

namespace limb_ring::scenario {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Of node0 to node2, after all have joined; `do` happens before.
std::string unmet_in_soak(const std::string& steps, const std::string& head = "") {
  return unmet_of("world: soak\n" + head + "steps:\n" + steps);
}
const char* const kSoakSend = "  - {at: 50us, do: {send: {name: one, from: node0, to: node2, size: 100}}}\n";
std::string when(const std::string& condition) { return "  - {when: " + condition + ", within: 5ms}\n"; }

TEST(SoakWorld, MendsAllAtItsEndAndIsWholeAgain) {
  EXPECT_EQ(unmet_in_soak("  - {at: 60us, do: {wire: {cut: node1 -> node2}}}\n"
                          "  - {at: 70us, do: {kill: node3}}\n"
                          "  - {at: 80us, do: {freeze: node0}}\n"
                          "  - {at: 90us, do: {not_reading: node1}}\n"
                          "  - {at: 2ms, do: {wire: {mend: node1 -> node2}}}\n"),
            "");
  EXPECT_EQ(unmet_in_soak("  - {at: 60us, do: {cable: {cut: node1 -> node2}}}\n", "redundancy: foldback\n"), "");
}

TEST(SoakWorld, LosesTheSliceThatIsNamed) {
  EXPECT_EQ(unmet_in_soak(kSoakSend + when("{results: one, are: delivered, at_least: 1}") +
                          when("{counter: retries, of: all, at_most: 0}")),
            "");
  EXPECT_EQ(unmet_in_soak("  - {at: 50us, do: {slice: {lost: node0 -> node1}}}\n" + std::string(kSoakSend) +
                          when("{counter: retries, of: node0, at_least: 1}") +
                          when("{results: one, are: delivered, at_least: 1}")),
            "");
}

TEST(SoakWorld, DamagesTheNthSliceInItsByte) {
  EXPECT_EQ(unmet_in_soak("  - {at: 50us, do: {slice: {damaged: node0 -> node1, nth: 2, byte: 3, bits: 4}}}\n" +
                          std::string(kSoakSend) + when("{counter: crc_errors, of: all, at_least: 1}") +
                          when("{results: one, are: delivered, at_least: 1}")),
            "");
}

TEST(SoakWorld, CancelsWhatWasAskedFor) {
  EXPECT_EQ(unmet_in_soak(std::string(kSoakSend) + "  - {at: 50us, do: {cancel: node0}}\n" +
                          when("{results: one, are: cancelled, at_least: 1}")),
            "");
}

TEST(SoakWorld, ExpectsThatTheRingIsWholeAgainAndIsVirtualAlone) {
  const Scenario scenario = parse_scenario(four_nodes("world: soak\nrate: unlimited\nsteps: []\n"), "t");
  EXPECT_TRUE(expects_something(scenario));
  EXPECT_THAT(only_virtual(scenario, ""), ElementsAre("world: soak"));
}

TEST(SoakWorld, RefusesWhatItDoesNotHave) {
  const auto refusal = [](const std::string& more) { return refusal_of(four_nodes(more)); };
  EXPECT_THAT(refusal("steps: [{do: {cancel: node0}}]\n"), HasSubstr("allowed: world: soak"));
  EXPECT_THAT(refusal("rate: unlimited\nsteps: []\n"), HasSubstr("is not possible here"));
  EXPECT_THAT(refusal("world: soak\nsteps: [{do: {hang: node0}}]\n"), HasSubstr("CPUs are not programs"));
  EXPECT_THAT(refusal("world: soak\nsteps: [{do: {wire: {cut: node1 -> node0}}}]\n"), HasSubstr("folds back"));
  EXPECT_THAT(refusal("world: soak\nsteps: [{do: {cable: {cut: node0 -> node1}}}]\n"),
              HasSubstr("allowed: redundancy"));
  EXPECT_THAT(refusal("world: soak\nsteps: [{do: {wire: {tear: node1 -> node0}}}]\n"), HasSubstr("cut"));
  EXPECT_THAT(refusal("world: soak\nsteps: [{do: {slice: {lost: node0 -> node1, byte: 1}}}]\n"), HasSubstr("byte"));
  EXPECT_THAT(refusal("world: moon\nsteps: []\n"), HasSubstr("usual, soak"));
}

// Steps 3 and 7 are needed, together.
TEST(NeededSteps, AreThoseWithoutWhichItDoesNotFail) {
  const auto fails = [](const std::vector<std::size_t>& steps) {
    return std::count(steps.begin(), steps.end(), 3u) + std::count(steps.begin(), steps.end(), 7u) == 2;
  };
  EXPECT_THAT(needed_steps(100, kMostShrinkingRuns, fails), ElementsAre(3u, 7u));
  EXPECT_EQ(needed_steps(100, 0, fails).size(), 100u) << "none may be tried";
}

}  // namespace
}  // namespace limb_ring::scenario
