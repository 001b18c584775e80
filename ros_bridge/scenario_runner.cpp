#include "ros_bridge/scenario_runner.h"

#include <signal.h>

#include <cerrno>
#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "io/program.h"
#include "io/regular_file.h"

namespace limb_ring::bridge {

namespace {

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
  arguments.insert(arguments.end(), {"--", file_of(order, folder)});  // a path is no option
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

}  // namespace

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

}  // namespace limb_ring::bridge
