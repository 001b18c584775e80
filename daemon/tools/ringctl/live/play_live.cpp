#include "tools/ringctl/live/play_live.h"

#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <fstream>

#include "config/quantity.h"
#include "config/yaml_file.h"
#include "ring/private_folder.h"
#include "tools/cli/output.h"
#include "tools/common/out_file.h"
#include "tools/ringctl/host_choice.h"
#include "tools/ringctl/live/live_stage.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/virtual/scenario_cpu.h"

namespace limb_ring::ringctl {

namespace {

YAML::Node plain_file(const config::RingConfig& ring) {
  YAML::Node file;
  file["ring"] = ring.ring;
  if (ring.folds_back()) file["redundancy"] = "foldback";
  for (const config::NodeConfig& node : ring.nodes) {
    YAML::Node entry;
    entry["id"] = static_cast<unsigned>(node.id);
    entry["name"] = node.name;
    file["nodes"].push_back(entry);
  }
  return file;
}

YAML::Node story_cpu() {
  YAML::Node cpu;
  cpu["command"].push_back(scenario_cpu());
  cpu["alive_period"] = config::format_time(scenario::kAlivePeriod);
  return cpu;
}

void write(const YAML::Node& file, const std::string& path) {
  YAML::Emitter text;
  text << file;
  std::ofstream out;
  std::string problem = app::open_for_writing(out, path);
  out << text.c_str() << '\n';
  if (problem.empty()) problem = cli::finish_writing(out, path);
  if (!problem.empty()) throw NotDone(problem);
}

/// The scenario's own ring, but the CPU of every node is scenario_cpu, which counts what it takes, and the ring has a
/// name that no other ring has.
/// @param folder where its file is written
/// @throw NotDone where scenario_cpu is not installed, or the file cannot be written
RingPlan plan_scenario_ring(const scenario::Scenario& scenario, const std::string& folder,
                            const std::string& transport) {
  const config::RingConfig& ring = scenario.ring;
  YAML::Node file = ring.path.empty() ? plain_file(ring) : config::parse_yaml(config::read_file(ring.path), ring.path);
  for (auto node : file["nodes"]) node["cpu"] = story_cpu();
  UpRequest request;
  request.config = folder + "/ring.yaml";
  request.ring = "scenario" + std::to_string(::getpid());  // UDP ports follow from it
  request.transport = transport;
  if (!ring.hosts.empty()) request.host = kAllHosts;
  write(file, request.config);
  return plan_ring(request);
}

}  // namespace

scenario::ScenarioRun play_live(const scenario::Scenario& scenario, std::uint64_t seed, const std::string& transport,
                                process::SignalWait& signals) {
  const live::PrivateFolder folder;
  const RingPlan plan = plan_scenario_ring(scenario, folder.path(), transport);
  LiveStage stage(scenario, seed, plan, signals);
  return run_scenario(scenario, seed, stage);
}

}  // namespace limb_ring::ringctl
