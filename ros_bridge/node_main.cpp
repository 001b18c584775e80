#include "ros_bridge/node_main.h"

#include <ros/ros.h>

#include <csignal>
#include <cstring>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include "config/config_error.h"
#include "io/standard_descriptors.h"
#include "tools/cli/output.h"
#include "tools/cli/roff.h"

namespace limb_ring::bridge {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 ended as asked, 1 could not run, 2 wrong arguments, parameters or configuration.\n";

bool asks_for_help(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (std::strcmp(argv[i], "--help") == 0 || std::strcmp(argv[i], "-h") == 0) return true;
  return false;
}

int complain(const std::exception& error, int code) {
  ROS_FATAL("%s", error.what());
  return code;
}

/// roscpp ends a node in order at SIGINT alone. What nohup has ignored stays so.
void end_in_order_when_asked() {
  for (const int signal : {SIGTERM, SIGHUP})
    if (std::signal(signal, [](int) { ros::requestShutdown(); }) == SIG_IGN) std::signal(signal, SIG_IGN);
}

/// Two nodes of one name would end each other for ever: the master ends the older one, and whatever restarts that one
/// thereby ends this one.
bool is_name_taken() {
  const std::string& name = ros::this_node::getName();
  if (!ros::service::exists(name + "/get_loggers", /*print_failure_reason=*/false)) return false;
  ROS_FATAL("node %s runs already, and `rosnode kill %s` ends it; or give this one a name or a namespace of its own",
            name.c_str(), name.c_str());
  return true;
}

int run_or_complain(const NodeProgram& program) {
  // When the last NodeHandle is destroyed, ROS shuts down, and rosconsole with it. This one keeps both alive until the
  // last message is out.
  const ros::NodeHandle until_all_is_said;
  try {
    program.run();
    return 0;
  } catch (const config::ConfigError& error) {
    return complain(error, 2);
  } catch (const std::invalid_argument& error) {
    return complain(error, 2);
  } catch (const std::exception& error) {
    return complain(error, 1);
  }
}

/// `man-page`, for the build.
bool asks_for_man_page(int argc, char** argv) { return argc == 2 && std::strcmp(argv[1], "man-page") == 0; }

}  // namespace

int run_node(int argc, char** argv, const NodeProgram& program) {
  process::open_standard_descriptors();
  process::outlive_file_limit();
  if (asks_for_help(argc, argv)) {
    std::cout << program.help << kExitCodes;
    return cli::code_with_output(program.name, 0);
  }
  if (asks_for_man_page(argc, argv)) {
    std::cout << cli::man_page_of_text(program.name, std::string(program.help) + kExitCodes,
                                       "[OPTIONS] _PARAMETER:=VALUE ...");
    return cli::code_with_output(program.name, 0);
  }
  try {
    ros::init(argc, argv, program.name);  // takes NAME:=VALUE out of argv
  } catch (const std::exception& error) {
    std::cerr << program.name << ": " << error.what() << std::endl;
    return 2;
  }
  end_in_order_when_asked();
  if (argc > 1) {
    std::cerr << program.name << ": unknown argument '" << argv[1] << "'; see " << program.name << " --help\n";
    return 2;
  }
  return is_name_taken() ? 2 : run_or_complain(program);
}

}  // namespace limb_ring::bridge
