#include "tools/ringctl/virtual/play_virtual.h"

#include <fcntl.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>

#include "io/unique_fd.h"
#include "node/program_ring.h"
#include "node/program_stage.h"
#include "ring/private_folder.h"
#include "tools/ringctl/problems.h"
#include "tools/ringctl/virtual/scenario_cpu.h"

namespace limb_ring::ringctl {

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
  if (play.log_problem != nullptr && !log_problem->empty()) *play.log_problem = *log_problem;
  return run;
}

}  // namespace limb_ring::ringctl
