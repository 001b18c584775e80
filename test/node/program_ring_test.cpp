// Which program is which node's CPU, and which scenarios cannot be played with programs.
#include "node/program_stage.h"

#include "sim/scenario_text.h"

namespace limb_ring::program_stage {
namespace {

using config::CpuConfig;
using namespace std::chrono_literals;
using scenario::four_nodes;
using scenario::Scenario;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Scenario with_own_program() {
  Scenario scenario = scenario::parse_scenario(four_nodes("steps: [{at: 1ms}]\n"), "test.yaml");
  CpuConfig& cpu = scenario.ring.nodes[1].cpu;
  cpu.kind = CpuConfig::Kind::child;
  cpu.command = {"own_cpu", "--fast"};
  cpu.turnaround = 40us;
  scenario.ring.nodes[2].cpu.kind = CpuConfig::Kind::attached;
  return scenario;
}

TEST(ProgramRing, ANodeHasTheProgramThatItsFileNamesAndElseTheStandIn) {
  const auto ring = ring_with_programs(with_own_program(), {"/x/scenario_cpu", false}, 1);
  EXPECT_THAT(ring.nodes[1].cpu.command, ElementsAre("own_cpu", "--fast"));
  EXPECT_EQ(ring.nodes[1].cpu.turnaround, 40us);
  for (const unsigned place : {0u, 2u, 3u}) {
    EXPECT_EQ(ring.nodes[place].cpu.kind, CpuConfig::Kind::child);
    EXPECT_THAT(ring.nodes[place].cpu.command, ElementsAre("/x/scenario_cpu"));
    EXPECT_EQ(ring.nodes[place].cpu.alive_period, scenario::kAlivePeriod);
  }
}

TEST(ProgramRing, TheStandInCanBeEverywhere) {
  const auto ring = ring_with_programs(with_own_program(), {"/x/scenario_cpu", true}, 1);
  EXPECT_THAT(ring.nodes[1].cpu.command, ElementsAre("/x/scenario_cpu"));
  EXPECT_EQ(ring.nodes[1].cpu.turnaround, 0us);
}

TEST(ProgramRing, BootTimeAndSeedAreTheScenarios) {
  Scenario scenario = with_own_program();
  scenario.boot_time = 50ms;
  const auto ring = ring_with_programs(scenario, {"/x/scenario_cpu", false}, 7);
  EXPECT_EQ(ring.virtual_clock.boot_time, 50ms);
  EXPECT_EQ(ring.virtual_clock.seed, 7u);
}

TEST(ProgramRing, AProgramThatIsNotThereIsNamedWithItsNode) {
  const auto ring = ring_with_programs(with_own_program(), {"/bin/true", false}, 1);
  EXPECT_THAT(missing_programs(ring), ElementsAre(HasSubstr("node1: no program 'own_cpu'")));
  EXPECT_THAT(missing_programs(ring_with_programs(with_own_program(), {"/bin/true", true}, 1)), IsEmpty());
}

}  // namespace
}  // namespace limb_ring::program_stage
