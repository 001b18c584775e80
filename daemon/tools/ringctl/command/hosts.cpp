#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "config/config_error.h"
#include "config/load_ring.h"
#include "node/key_file.h"
#include "tools/common/out_file.h"
#include "tools/common/ring_file.h"
#include "tools/ringctl/command/commands.h"
#include "tools/ringctl/machines_file.h"
#include "tools/ringctl/problems.h"

namespace limb_ring::ringctl {

namespace {

int make_key(const std::string& file) {
  if (const std::string problem = app::why_no_file(file); !problem.empty()) throw UsageError(problem);
  try {
    config::make_key_file(file);
  } catch (const config::ConfigError& problem) {
    throw NotDone(problem.what());
  }
  // A path in a ring's file counts from the folder of that file, not from where the user stands now.
  const std::string name = file.substr(file.rfind('/') + 1);
  std::cout << "made " << file
            << ": copy it to all hosts of the ring (scp -p), and name it in a ring's file in the same "
            << "folder: links: {key: " << name << "}; elsewhere by its absolute path" << std::endl;
  return kDone;
}

void add_key(CLI::App& app, Context& context) {
  auto file = std::make_shared<std::string>();
  CLI::App* command =
      add_command(app, "key", "Make a key for the UDP lines between hosts", "ringctl hosts key robot.key");
  command->add_option("FILE", *file, "A new file; its mode will be 0600")->required();
  command->callback([&context, file] {
    context.action = [&context, file] {
      require_no_ring(context, "a key is of no ring yet");
      return make_key(*file);
    };
  });
}

struct LaunchOptions {
  std::string config, env_loader, user;
};

int print_launch(const LaunchOptions& options) {
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

void add_launch(CLI::App& app, Context& context) {
  auto options = std::make_shared<LaunchOptions>();
  CLI::App* command = add_command(app, "launch", "Print a launch file for a ring over several hosts",
                                  "ringctl hosts launch robot.yaml --user robot > robot_machines.launch",
                                  "Use it as 'roslaunch limb_ring ring.launch config:=CONFIG machines:=FILE'.");
  command->add_option("CONFIG", options->config, "YAML file of the ring, with `hosts`, or its name (see up)")
      ->required();
  command->add_option("--env-loader", options->env_loader,
                      "Script on each host that sets up ROS and runs its arguments; default: env.sh of this shell's "
                      "catkin workspace, or /usr/bin/env without one");
  command->add_option("--user", options->user, "User to log in as, if a host's `ssh` does not name one");
  command->callback([&context, options] {
    context.action = [&context, options] {
      require_no_ring(context, "the ring is that of CONFIG");
      return print_launch(*options);
    };
  });
}

}  // namespace

void add_hosts(CLI::App& app, Context& context) {
  CLI::App& hosts =
      add_group(app, "hosts", "Make a key and a launch file for several hosts", "ringctl hosts key robot.key");
  add_key(hosts, context);
  add_launch(hosts, context);
}

}  // namespace limb_ring::ringctl
