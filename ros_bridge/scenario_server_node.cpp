// scenario_server: plays scenarios for whoever asks by the service run_scenario, one after the other. A node apart
// from ring_bridge: a scenario takes seconds, and runs a ring of its own.
#include <limb_ring/RunScenario.h>
#include <ros/ros.h>

#include <exception>
#include <stdexcept>

#include "ros_bridge/node_main.h"
#include "ros_bridge/scenario_runner.h"

namespace {

using limb_ring::RunScenario;

constexpr const char* kHelp =
    "scenario_server: offers the service run_scenario (limb_ring/RunScenario). No parameters.\n";

bool run_scenario(RunScenario::Request& request, RunScenario::Response& response) {
  try {
    const auto end = limb_ring::bridge::play_scenario(
        {request.path, request.text, request.live != 0, request.programs != 0, request.seed}, ros::ok);
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

int main(int argc, char** argv) { return limb_ring::bridge::run_node(argc, argv, {"scenario_server", kHelp, run}); }
