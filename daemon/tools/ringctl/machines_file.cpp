#include "tools/ringctl/machines_file.h"

#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "config/xml_text.h"
#include "tools/ringctl/host_choice.h"

namespace limb_ring::ringctl {
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

}  // namespace limb_ring::ringctl
