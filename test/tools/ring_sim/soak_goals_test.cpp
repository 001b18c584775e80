// What `ring_sim soak` says of goals, situations in which a ring has to be seen; and `ring_sim cause` of worlds.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tools/ring_sim/command_line.h"
#include "tools/ring_sim/run_ring_sim.h"

namespace limb_ring::ring_sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(SoakGoals, ThatAreRequiredAndNeverMetEndItWithExitCodeOne) {
  const std::vector<std::string> soak{"soak", "--first", "1", "--seeds", "2"};
  const CliRun plain = ring_sim(soak);
  EXPECT_EQ(plain.code, kDone);
  EXPECT_THAT(plain.out, AllOf(HasSubstr("Goals met: "), HasSubstr("; never: ")));
  EXPECT_THAT(plain.out, Not(HasSubstr("hosts_regroup"))) << "the usual world has no hosts that part";
  std::vector<std::string> required = soak;
  required.emplace_back("--require-goals");
  const CliRun strict = ring_sim(required);
  EXPECT_EQ(strict.code, kBroken);
  EXPECT_THAT(strict.errors, HasSubstr("never met: none_left: no node is left"));
}

TEST(SoakGoals, AreListedAndInJson) {
  const CliRun listed = ring_sim({"soak", "--first", "1", "--seeds", "1", "--goals"});
  EXPECT_THAT(listed.out, HasSubstr("breaks_in_a_lap"));
  const CliRun json = ring_sim({"soak", "--first", "1", "--seeds", "1", "--json"});
  EXPECT_TRUE(nlohmann::json::parse(json.out)["goals"]["breaks_in_a_lap"].contains("seeds"));
}

TEST(SoakGoals, AreSoughtInTheSmallestWorldThatCanMeetThem) {
  const CliRun sought = ring_sim({"soak", "--first", "1", "--seeds", "10", "--seek", "hosts_regroup", "--json"});
  EXPECT_EQ(sought.code, kDone) << sought.errors;
  EXPECT_GT(nlohmann::json::parse(sought.out)["goals"]["hosts_regroup"]["times"], 0);
}

TEST(SoakGoals, ThatAreUnknownCannotBeSought) {
  const CliRun unknown = ring_sim({"soak", "--seeds", "1", "--seek", "moonlight"});
  EXPECT_EQ(unknown.code, kUsage);
  EXPECT_THAT(unknown.errors, HasSubstr("'moonlight' is not a goal; 'ring_sim soak --goals' lists them"));
  const CliRun shrunk = ring_sim({"soak", "--seeds", "1", "--seek", "cut_off", "--shrink", "/tmp"});
  EXPECT_EQ(shrunk.code, kUsage);
}

// With the seeds so far the goals that were unmet are drawn, and said.
TEST(SoakGoals, ThatWereNeverMetAreSoughtByEverySecondSeed) {
  const CliRun run = ring_sim({"soak", "--first", "1", "--seeds", "120", "--seek", "unmet"});
  EXPECT_EQ(run.code, kDone) << run.errors;
  EXPECT_THAT(run.errors, HasSubstr("From seed 101 on every second seed seeks one of: "));
}

TEST(Cause, IsLookedForInEveryWorldAndWrittenOnlyOfTheUsualOne) {
  for (const char* world : {"usual", "wide", "parts", "storms"}) {
    const CliRun whole = ring_sim({"cause", "1", "--world", world, "--drift", "100", "--clocks"});
    EXPECT_EQ(whole.code, kBroken);
    EXPECT_THAT(whole.errors, HasSubstr("this seed breaks no promise: there is no cause to find")) << world;
  }
  const CliRun written = ring_sim({"cause", "1", "--world", "parts", "-o", "cause.yaml"});
  EXPECT_EQ(written.code, kUsage);
  EXPECT_THAT(written.errors, HasSubstr("--out goes only with seeds of the usual world"));
}

}  // namespace
}  // namespace limb_ring::ring_sim
