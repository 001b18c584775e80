#include "tools/ringctl/hosts.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "config/load_ring.h"
#include "config/quantity.h"
#include "config/ring_config.h"
#include "config/urdf_joints.h"
#include "io/program.h"
#include "node/link_settings.h"
#include "ring/running_daemons.h"
#include "tools/common/ring_file.h"
#include "tools/common/text_table.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/screen.h"

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

namespace {

std::string attribute(const char* name, const std::string& value) {
  return value.empty() ? "" : std::string(" ") + name + "=\"" + config::xml_text(value) + '"';
}

struct Login {
  std::string user, address;
};

/// `ssh: USER@ADDRESS` or `ssh: ADDRESS`, where the host has it.
Login login_of(const config::HostConfig& host, const std::string& user) {
  const std::string& destination = host.ssh_destination();
  const auto at = destination.find('@');
  return at == std::string::npos ? Login{user, destination}
                                 : Login{destination.substr(0, at), destination.substr(at + 1)};
}

}  // namespace

std::string machines_file(const config::RingConfig& ring, const std::string& env_loader, const std::string& user) {
  if (ring.hosts.empty())
    throw std::invalid_argument(ring.path + ": has no 'hosts', so there is nothing to start elsewhere");
  std::ostringstream file;
  file << "<launch>\n"
          "  <!-- The hosts of a ring, for ring.launch machines:=THIS_FILE. env-loader is a script on the host that "
          "sets up ROS\n"
          "       and runs its arguments, such as env.sh of a catkin workspace; user, ssh-port and timeout (s) may be\n"
          "       added: https://wiki.ros.org/roslaunch/XML/machine -->\n";
  for (const auto& host : ring.hosts) {
    if (!has_nodes(ring, host)) continue;
    const Login login = login_of(host, user);
    const bool has_bridge = ring.host_of(config::body_of(ring))->name == host.name;
    file << "  <machine" << attribute("name", host.name) << attribute("address", login.address)
         << attribute("user", login.user) << attribute("env-loader", env_loader)
         << " timeout=\"30\"/>\n"
            "  <include file=\"$(find limb_ring)/launch/host.launch\" pass_all_args=\"true\">\n"
            "    <arg"
         << attribute("name", "host") << attribute("value", host.name) << "/>\n    <arg"
         << attribute("name", "has_bridge") << attribute("value", has_bridge ? "true" : "false")
         << "/>\n"
            "  </include>\n";
  }
  file << "</launch>\n";
  return file.str();
}

std::string usual_env_loader(const std::string& prefix_path) {
  std::istringstream folders(prefix_path);
  std::error_code error;
  for (std::string folder; std::getline(folders, folder, ':');)
    if (std::filesystem::exists(folder + "/env.sh", error)) return folder + "/env.sh";
  return "/usr/bin/env";
}

namespace {

constexpr int kSecondsToConnect = 10;

/// ssh says 255 where it does not get there; that is none of our exit codes.
std::string with_our_codes() {
  return "ssh \"$@\"; code=$?; [ $code -eq 255 ] && exit " + std::to_string(kNoRing) + "; exit $code";
}

}  // namespace

std::vector<std::string> arguments_there(const std::string& ring, std::vector<std::string> arguments) {
  if (!ring.empty() && typed_ring(arguments).empty()) arguments.insert(arguments.begin(), {"--ring", ring});
  return arguments;
}

std::string command_there(const std::string& program, const std::string& folder,
                          const std::vector<std::string>& arguments) {
  std::string command = "cd " + app::shell_word(folder) + " 2>/dev/null; p=" + app::shell_word(program) +
                        "; [ -x \"$p\" ] || p=ringctl; exec \"$p\"";
  for (const std::string& argument : arguments) command += ' ' + app::shell_word(argument);
  return command;
}

int run_there(const Elsewhere& where, const std::vector<std::string>& arguments) {
  std::error_code ignored;
  const std::string command =
      command_there(process::own_folder() + "/ringctl", std::filesystem::current_path(ignored).string(),
                    arguments_there(where.ring, arguments));
  const int error = process::execute(
      "/bin/sh", {"sh", "-c", with_our_codes(), "sh", "-n", "-o", "BatchMode=yes", "-o",
                  "ConnectTimeout=" + std::to_string(kSecondsToConnect), "--", where.destination, command});
  tell_user(std::string("/bin/sh: ") + std::strerror(error));
  return kNoRing;
}

namespace {

using config::HostConfig;
using config::RingConfig;

const std::string kAllHere = "'--host all' runs all nodes on this machine, to try the file out";

std::string file_of(const RingConfig& ring) { return ring.path.empty() ? "the ring" : ring.path; }

std::string with_addresses(const RingConfig& ring) {
  std::vector<std::string> hosts;
  for (const HostConfig& host : ring.hosts) hosts.push_back(host.name + " " + host.address);
  return config::join(hosts);
}

UsageError unknown_host(const RingConfig& ring, const std::string& given) {
  std::vector<std::string> names;
  for (const HostConfig& host : ring.hosts) names.push_back(host.name);
  const std::string meant = config::closest(given, names);
  return UsageError("unknown host '" + given + "'" + (meant.empty() ? ". " : ", did you mean '" + meant + "'? ") +
                    file_of(ring) + " has: " + config::join(names));
}

std::string the_only_own(const RingConfig& ring) {
  std::vector<std::string> own;
  for (const HostConfig& host : ring.hosts)
    if (has_nodes(ring, host) && live::is_own_address(host.address)) own.push_back(host.name);
  if (own.size() == 1) return own.front();
  if (own.empty())
    throw UsageError("no host of " + file_of(ring) + " has an address of this machine (" + with_addresses(ring) +
                     "); " + kAllHere);
  throw UsageError("several hosts of " + file_of(ring) + " have an address of this machine (" + config::join(own) +
                   "): say with --host NAME which one it is; " + kAllHere);
}

}  // namespace

bool has_nodes(const RingConfig& ring, const HostConfig& host) {
  return std::any_of(ring.nodes.begin(), ring.nodes.end(),
                     [&](const config::NodeConfig& node) { return ring.host_of(node) == &host; });
}

std::string not_here(const HostConfig& host) {
  return "host '" + host.name + "' has the address " + host.address + ", which no interface of this machine has";
}

std::string chosen_host(const RingConfig& ring, const std::string& given) {
  if (given == kAllHosts) return ring.hosts.empty() ? "" : given;
  if (ring.hosts.empty()) {
    if (given.empty()) return given;
    throw UsageError("--host: " + file_of(ring) + " has no `hosts`; leave --host out");
  }
  if (given.empty()) return the_only_own(ring);
  const HostConfig* host = ring.find_host(given);
  if (host == nullptr) throw unknown_host(ring, given);
  if (!has_nodes(ring, *host))
    throw UsageError("host '" + given + "' has no nodes: no node of " + file_of(ring) + " names it");
  if (!live::is_own_address(host->address))
    throw Elsewhere(not_here(*host) + "; start it there, or correct `hosts`", host->ssh_destination());
  return given;
}

}  // namespace limb_ring::ringctl
