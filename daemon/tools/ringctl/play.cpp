#include "tools/ringctl/play.h"

#include <fcntl.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>

#include "config/entry.h"
#include "config/quantity.h"
#include "io/program.h"
#include "io/unique_fd.h"
#include "node/program_stage.h"
#include "ring/launched_ring.h"
#include "tools/common/command_line.h"
#include "tools/common/ring_file.h"
#include "tools/ringctl/hosts.h"
#include "tools/ringctl/live_stage.h"
#include "tools/ringctl/screen.h"

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
  const std::string problem = app::write_file(path, std::string(text.c_str()) + '\n');
  if (!problem.empty()) throw NotDone(problem);
}

/// The scenario's own ring, but the CPU of every node is scenario_cpu, which counts what it takes, and the ring has a
/// name that no other ring has.
/// @param folder where its file is written
/// @throw NotDone if scenario_cpu is not installed, or the file cannot be written
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

void throw_if_interrupted(const process::SignalWait& signals) {
  if (signals.was_asked_to_end()) throw Interrupted();
}

scenario::ScenarioRun play_live(const scenario::Scenario& scenario, std::uint64_t seed, const std::string& transport,
                                process::SignalWait& signals) {
  const live::PrivateFolder folder;
  const RingPlan plan = plan_scenario_ring(scenario, folder.path(), transport);
  LiveStage stage(scenario, seed, plan, signals);
  return run_scenario(scenario, seed, stage);
}

namespace {

config::RingConfig ring_of(const scenario::Scenario& scenario, std::uint64_t seed, const VirtualPlay& play) {
  return program_stage::ring_with_programs(scenario, {scenario_cpu(), play.scenario_cpus}, seed);
}

/// Where what programs print and nodes log goes: to the end of a file, or nowhere.
process::UniqueFd open_log(const std::string& path) {
  const std::string file = path.empty() ? "/dev/null" : path;
  process::UniqueFd log(::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666));
  if (!log.valid()) throw UsageError("cannot write " + file + ": " + std::strerror(errno));
  return log;
}

/// @return gets what spdlog could not write, and why
std::shared_ptr<std::string> log_to(const std::string& path) {
  const auto sink = std::make_shared<spdlog::sinks::basic_file_sink_st>(path.empty() ? "/dev/null" : path);
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("ringctl", sink));
  spdlog::set_pattern("%v");
  spdlog::flush_on(spdlog::level::info);
  auto problem = std::make_shared<std::string>();
  spdlog::default_logger()->set_error_handler([problem, path](const std::string& what) {
    if (problem->empty()) *problem = path + ": not all could be written: " + what.substr(what.rfind(':') + 2);
  });
  return problem;
}

/// Not held back as long as it lives.
class LetThrough {
 public:
  explicit LetThrough(const process::SignalWait& signals) : signals_(signals) { signals_.release(); }
  ~LetThrough() { signals_.hold(); }
  LetThrough(const LetThrough&) = delete;
  LetThrough& operator=(const LetThrough&) = delete;

 private:
  const process::SignalWait& signals_;
};

}  // namespace

void require_virtual(const scenario::Scenario& scenario, const VirtualPlay& play) {
  std::string text;
  for (const std::string& reason : program_stage::not_with_programs(scenario)) text += "\n  " + reason;
  if (!text.empty()) throw UsageError(scenario.path + ": not with real programs (--virtual):" + text);
  for (const std::string& missing : program_stage::missing_programs(ring_of(scenario, 0, play)))
    text += "\n  " + missing;
  if (!text.empty()) throw UsageError(scenario.path + ": programs that are not there:" + text);
  open_log(play.log);
}

scenario::ScenarioRun play_virtual(const scenario::Scenario& scenario, std::uint64_t seed, const VirtualPlay& play,
                                   const process::SignalWait& signals) {
  const live::PrivateFolder folder;
  const config::RingConfig ring = ring_of(scenario, seed, play);
  const process::UniqueFd log = open_log(play.log);
  const std::shared_ptr<std::string> log_problem = log_to(play.log);
  program_stage::ProgramStage stage(scenario, ring, seed, log.get());
  std::optional<sim::RingCapture> captured;
  if (play.capture != nullptr) captured.emplace(stage.ring(), *play.capture, sim::names_of(ring), play.at);
  const LetThrough signals_for_stage(signals);
  scenario::ScenarioRun run = run_scenario(scenario, seed, stage);
  run.trace = stage.trace();
  run.order = ring.virtual_clock.order;
  if (play.log_problem != nullptr && !log_problem->empty()) *play.log_problem = *log_problem;
  return run;
}

std::string scenario_cpu() {
  const std::string program = process::find_program("scenario_cpu");
  if (program.empty())
    throw NotDone("no program scenario_cpu beside ringctl (" + process::own_folder() + ") or on PATH");
  return program;
}

}  // namespace limb_ring::ringctl
