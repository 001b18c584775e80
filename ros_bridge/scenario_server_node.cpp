// scenario_server: plays scenarios for whoever asks by the service run_scenario, one after the other. A node apart
// from ring_bridge: a scenario takes seconds, and runs a ring of its own.
#include <limb_ring/RunScenario.h>
#include <ros/ros.h>
#include <signal.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <exception>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "io/program.h"
#include "io/regular_file.h"
#include "ros_bridge/node_main.h"

namespace limb_ring::bridge {
namespace {

/// What RunScenario.srv asks for.
struct ScenarioOrder {
  std::string path, text;               ///< one of them
  bool live = false, programs = false;  ///< not both
  std::uint64_t seed = 0;               ///< 0: the file's own
};

struct ScenarioEnd {
  int exit_code = 0;  ///< of ringctl
  std::string report, junit;
};

using process::TemporaryFolder;

constexpr std::chrono::milliseconds kTick{20};

std::string content(const std::string& file) {
  std::ostringstream text;
  if (std::ifstream in(file); in.peek() != std::ifstream::traits_type::eof()) text << in.rdbuf();
  return text.str();
}

std::string file_of(const ScenarioOrder& order, const TemporaryFolder& folder) {
  if (order.path.empty() == order.text.empty())
    throw std::invalid_argument("give either path, a scenario's file, or text, its YAML");
  if (!order.path.empty()) return order.path;
  const std::string file = folder.file("scenario.yaml");
  errno = 0;
  std::ofstream out(file);
  if (!(out << order.text).flush())  // a part of it could be a scenario, too
    throw std::system_error(errno, std::generic_category(), "cannot write the scenario to " + file);
  return file;
}

std::vector<std::string> arguments_of(const ScenarioOrder& order, const TemporaryFolder& folder) {
  if (order.live && order.programs)
    throw std::invalid_argument(
        "give either live, for live daemons, or programs, for a virtual ring with real programs");
  const char* where = order.live ? "--live" : order.programs ? "--virtual" : "--sim";
  std::vector<std::string> arguments{"scenario", "run", where, "--junit", folder.file("junit.xml")};
  if (order.seed != 0) arguments.insert(arguments.end(), {"--seed", std::to_string(order.seed)});
  arguments.insert(arguments.end(), {"--", file_of(order, folder)});  // a path is not an option
  return arguments;
}

/// ringctl's own deadlines end it. @return its exit code
int wait_for(process::Program& ringctl, const std::function<bool()>& go_on) {
  bool interrupted = false;
  for (ringctl.reap(); !ringctl.ended(); ringctl.reap()) {
    if (!interrupted && !go_on()) {
      ringctl.signal(SIGINT);
      interrupted = true;
    }
    std::this_thread::sleep_for(kTick);
  }
  const process::ExitStatus& end = *ringctl.ended();
  if (!end.executed) throw std::runtime_error(end.text);
  if (!end.code) throw std::runtime_error("ringctl was ended by " + end.text);
  return *end.code;
}

/// Plays a scenario in a ringctl of its own and waits until it has ended. Blocks.
/// @param go_on asked many times a second; if it says no, the run is interrupted as by Ctrl-C
/// @throw std::invalid_argument if not exactly one of path and text is given, or both live and programs;
///        std::runtime_error where ringctl cannot be started
ScenarioEnd play_scenario(const ScenarioOrder& order, const std::function<bool()>& go_on) {
  const TemporaryFolder folder("scenario");
  ScenarioEnd end;
  process::ProgramRequest request;
  request.name = "ringctl";
  request.arguments = arguments_of(order, folder);
  request.log = folder.file("report");
  process::Program ringctl(request);
  end.exit_code = wait_for(ringctl, go_on);
  end.report = ringctl.output();
  end.junit = content(folder.file("junit.xml"));
  return end;
}

constexpr const char* kHelp =
    "scenario_server: offers the service run_scenario (limb_ring/RunScenario). No parameters.\n";

bool run_scenario(RunScenario::Request& request, RunScenario::Response& response) {
  try {
    const auto end =
        play_scenario({request.path, request.text, request.live != 0, request.programs != 0, request.seed}, ros::ok);
    response.exit_code = end.exit_code;
    response.report = end.report;
    response.junit = end.junit;
  } catch (const std::invalid_argument& problem) {
    response.exit_code = 2;
    response.report = problem.what();
  } catch (const std::exception& problem) {
    response.exit_code = 1;
    response.report = problem.what();
  }
  response.success = response.exit_code == 0;
  return true;
}

void run() {
  ros::NodeHandle nodes;
  const auto server = nodes.advertiseService("run_scenario", &run_scenario);
  ros::spin();
}

}  // namespace
}  // namespace limb_ring::bridge

int main(int argc, char** argv) {
  return limb_ring::bridge::run_node(argc, argv, {"scenario_server", limb_ring::bridge::kHelp, limb_ring::bridge::run});
}
