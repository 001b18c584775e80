// The ring's supervisor under a virtual clock: four nodes with policy auto, a grace of 500 ms and a beacon each 100 ms.
#include <fstream>

#include "sim/scenario_text.h"

namespace limb_ring::scenario {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kHang = "steps:\n  - {at: 2s, do: {hang: node2}}\n";

class SupervisorRun : public testing::Test {
 protected:
  std::string unmet(const std::string& policy, const std::string& more) {
    const std::string ring = testing::TempDir() + "supervisor_test_ring.yaml";
    std::ofstream(ring) << "ring: watched\nnodes:\n  - {id: 0, name: node0}\n  - {id: 1, name: node1}\n"
                           "  - {id: 2, name: node2}\n  - {id: 3, name: node3}\n"
                           "supervisor: {policy: " +
                               policy + ", grace: 500ms, backoff: 500ms, tries: 2}\n";
    const Scenario scenario = parse_scenario("scenario: a test\nring: " + ring + "\n" + more, "/test.yaml");
    const ScenarioRun run = run_scenario(scenario, 1);
    return run.unmet ? run.unmet->expected + "; " + run.unmet->seen : "";
  }
};

TEST_F(SupervisorRun, ResetsAHungCpuABeaconPeriodAfterItIsKnown) {
  EXPECT_EQ(unmet("auto", std::string(kHang) + "  - {when: {cpu: node2, is: silent, boots: 1}, within: 601ms}\n"
                                               "  - {when: {cpu: node2, is: running, boots: 2}, within: 121ms}\n"),
            "");
}

TEST_F(SupervisorRun, ABootTakesAsLongAsTheScenarioSays) {
  const std::string done = std::string(kHang) + "  - {when: {cpu: node2, is: running, boots: 2}, within: ";
  EXPECT_EQ(unmet("auto", "boot_time: 300ms\n" + done + "1001ms}\n"), "");
  EXPECT_THAT(unmet("auto", "boot_time: 500ms\n" + done + "1001ms}\n"),
              HasSubstr("node0 has heard that it is booting"));
}

TEST_F(SupervisorRun, LeavesItAloneIfItOnlyReports) {
  EXPECT_THAT(unmet("report", std::string(kHang) + "  - {when: {cpu: node2, is: running, boots: 2}, within: 10s}\n"),
              HasSubstr("it is silent in boot 1"));
}

TEST_F(SupervisorRun, LeavesACpuAloneThatIsWellAgainInTime) {
  EXPECT_EQ(unmet("auto",
                  "steps:\n  - {at: 2s, do: {hang: {nodes: node2, for: 500ms}}}\n"
                  "  - {when: {cpu: node1, boots: 1}, within: 0s}\n  - {at: 10s}\n"
                  "never: [{cpu: node2, boots: 2}]\n"),
            "");
}

TEST_F(SupervisorRun, ADeadSupervisorResetsNobody) {
  EXPECT_THAT(unmet("auto",
                    "steps:\n  - {at: 2s, do: {kill: node0}}\n  - {do: {hang: node2}}\n"
                    "  - {when: {cpu: node2, is: running, boots: 2}, within: 10s}\n"),
              HasSubstr("it is silent in boot 1"));
}

TEST_F(SupervisorRun, ItsOwnCpuIsWatchedAsTheOthersAre) {
  EXPECT_EQ(unmet("auto",
                  "steps:\n  - {at: 2s, do: {hang: node0}}\n"
                  "  - {when: {cpu: node0, is: running, boots: 2}, within: 721ms}\n"),
            "");
}

TEST_F(SupervisorRun, WhatHangsAfterEveryResetIsGivenUp) {
  std::string steps = "steps:\n";
  for (const char* boots : {"1", "2", "3"})
    steps += std::string("  - {when: {cpu: node2, is: running, boots: ") + boots + "}, within: 5s}\n" +
             "  - {do: {hang: node2}}\n";
  EXPECT_THAT(unmet("auto", steps + "  - {when: {cpu: node2, is: running, boots: 4}, within: 30s}\n"),
              StartsWith("when {cpu: node2, is: running, boots: 4}"));
}

}  // namespace
}  // namespace limb_ring::scenario
