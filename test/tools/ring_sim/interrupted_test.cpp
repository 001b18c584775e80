// Ctrl-C where ring_sim would go on for long.
#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "io/signal_wait.h"
#include "tools/ring_sim/command_line.h"
#include "tools/ring_sim/run_ring_sim.h"

namespace limb_ring::ring_sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Of a process that was sent SIGINT just before.
CliRun interrupted(const std::vector<std::string>& arguments) {
  const process::SignalWait held_back;
  ::kill(::getpid(), SIGINT);
  return ring_sim(arguments);
}

TEST(Interrupted, ASoakEndsBetweenSeedsAndPrintsItsTable) {
  const CliRun said = interrupted({"soak", "--first", "1", "--seeds", "100000", "--json"});
  EXPECT_EQ(said.code, kBroken);
  EXPECT_EQ(nlohmann::json::parse(said.out)["seeds"], 0);
  EXPECT_THAT(said.errors, HasSubstr("interrupted: 0 of 100000 seeds were run, 0 of them broke a promise"));
}

TEST(Interrupted, AnExplorationEndsBetweenRunsAndPrintsItsTable) {
  const CliRun said = interrupted({"explore", "--faults", "2", "--threads", "2"});
  EXPECT_EQ(said.code, kBroken);
  EXPECT_THAT(said.out, AllOf(HasSubstr("recognised"), Not(HasSubstr("Exhausted"))));
  EXPECT_THAT(said.errors, HasSubstr("interrupted: no promise was broken so far, but not all was run"));
}

}  // namespace
}  // namespace limb_ring::ring_sim
