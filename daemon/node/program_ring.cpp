#include "node/program_ring.h"

#include "config/quantity.h"
#include "io/find_program.h"

namespace limb_ring::program_stage {

using config::CpuConfig;
using scenario::Scenario;
using std::chrono::milliseconds;

std::vector<std::string> not_with_programs(const Scenario& scenario) {
  std::vector<std::string> reasons;
  if (scenario.world == scenario::World::soak) reasons.emplace_back("world: soak: its CPUs are no programs");
  if (scenario.boot_time != std::chrono::floor<milliseconds>(scenario.boot_time))
    reasons.push_back("boot_time: " + config::format_time(scenario.boot_time) +
                      ": of real programs it is whole milliseconds");
  return reasons;
}

std::vector<std::string> missing_programs(const config::RingConfig& ring) {
  std::vector<std::string> missing;
  for (const config::NodeConfig& node : ring.nodes)
    if (const std::string& name = node.cpu.command.front(); process::find_program(name).empty())
      missing.push_back(node.name + ": " + process::no_program(name));
  return missing;
}

config::RingConfig ring_with_programs(const Scenario& scenario, const StandIn& stand_in, std::uint64_t seed) {
  config::RingConfig ring = scenario.ring;
  for (config::NodeConfig& node : ring.nodes) {
    if (node.cpu.kind == CpuConfig::Kind::child && !stand_in.everywhere) continue;
    node.cpu = {};
    node.cpu.kind = CpuConfig::Kind::child;
    node.cpu.command = {stand_in.path};
    node.cpu.alive_period = scenario::kAlivePeriod;
  }
  ring.virtual_clock.boot_time = std::chrono::floor<milliseconds>(scenario.boot_time);
  ring.virtual_clock.seed = static_cast<std::uint32_t>(seed);
  return ring;
}

}  // namespace limb_ring::program_stage
