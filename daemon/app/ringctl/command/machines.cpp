#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "app/common/ring_file.h"
#include "app/ringctl/command/commands.h"
#include "app/ringctl/machines_file.h"
#include "app/ringctl/problems.h"
#include "config/load_ring.h"

namespace limb_ring::ringctl {

namespace {

struct MachinesOptions {
  std::string config, env_loader, user;
};

int run(const MachinesOptions& options) {
  const config::RingConfig ring = config::load_ring(app::ring_file(options.config));
  const char* prefixes = std::getenv("CMAKE_PREFIX_PATH");
  const std::string usual = usual_env_loader(prefixes ? prefixes : "");
  try {
    std::cout << machines_file(ring, options.env_loader.empty() ? usual : options.env_loader, options.user);
  } catch (const std::invalid_argument& problem) {
    throw UsageError(problem.what());
  }
  return kDone;
}

}  // namespace

void add_machines(CLI::App& app, Context& context) {
  auto options = std::make_shared<MachinesOptions>();
  CLI::App* command = add_command(app, "machines",
                                  "Print a launch file with the hosts of a ring, for 'roslaunch limb_ring ring.launch "
                                  "config:=CONFIG machines:=FILE'");
  command->add_option("CONFIG", options->config, "YAML file of the ring, with `hosts`, or its name (see up)")
      ->required();
  command->add_option("--env-loader", options->env_loader,
                      "Script on each host that sets up ROS and runs its arguments; default: env.sh of this shell's "
                      "catkin workspace, or /usr/bin/env where there is none");
  command->add_option("--user", options->user, "Whom to log in as, where a host's `ssh` does not say");
  command->callback([&context, options] { context.action = [options] { return run(*options); }; });
}

}  // namespace limb_ring::ringctl
