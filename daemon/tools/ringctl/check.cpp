#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

#include "config/entry.h"
#include "config/load_ring.h"
#include "config/quantity.h"
#include "config/urdf_joints.h"
#include "node/link_settings.h"
#include "sim/load_scenario.h"
#include "tools/common/ring_file.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/ring_access.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {
namespace {

std::string counted(std::size_t count, const char* what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

std::string ring_words(const config::RingConfig& ring) {
  std::size_t joints = 0, sensors = 0;
  for (const config::NodeConfig& node : ring.nodes) {
    joints += node.joints.size();
    sensors += node.sensors.size();
  }
  return "ring " + ring.ring + ", " + counted(ring.nodes.size(), "node") + ", " + counted(joints, "joint") +
         (ring.followers.empty() ? "" : " (" + std::to_string(ring.followers.size()) + " more follow them)") + ", " +
         counted(sensors, "sensor");
}

std::string urdf_words(const std::string& path) {
  const config::UrdfJoints urdf = config::parse_urdf(config::read_file(path), path, /*whole=*/true);
  std::size_t driven = 0, mimics = 0;
  for (const auto& [name, joint] : urdf.joints) {
    driven += joint.has_motor();
    mimics += joint.mimic.has_value();
  }
  return "robot " + urdf.robot + ", " + counted(driven, "joint") + " with a motor" +
         (mimics == 0 ? "" : ", " + std::to_string(mimics) + " that follow them") + "; 'ringctl new " + path +
         "' writes a ring for it";
}

/// By what stands in it: the file of a ring has nodes that are a list.
bool is_scenario(const std::string& path) {
  const YAML::Node file = config::parse_yaml(config::read_file(path), path);
  if (!file.IsMap()) return false;
  for (const char* entry : {"scenario", "steps", "always", "never", "world"})
    if (file[entry]) return true;
  return false;
}

std::string words_of(const std::string& given) {
  const std::string ending = std::filesystem::path(given).extension().string();
  for (const char* robot : {".urdf", ".xacro", ".sdf", ".xml", ".dae"})
    if (ending == robot) return urdf_words(given);
  const std::string path = app::ring_file(given);
  if (is_scenario(path)) {
    const scenario::Scenario scenario = scenario::load_scenario(path);
    return "scenario '" + scenario.name + "', " + counted(scenario.steps.size(), "step") + ", on " +
           ring_words(scenario.ring);
  }
  const config::RingConfig ring = config::load_ring(path);
  for (const std::string& warning : ring.warnings) tell_user("warning: " + warning);
  return ring_words(ring);
}

int check(const std::vector<std::string>& files) {
  bool all_right = true;
  for (const std::string& file : files) {
    try {
      const std::string words = words_of(file);
      std::cout << file << " is right: " << words << std::endl;
    } catch (const config::ConfigError& problem) {
      std::cerr << problem.what() << std::endl;
      all_right = false;
    }
  }
  return all_right ? kDone : kUsage;
}

std::string hexadecimal(const link::Agreement& agreement) {
  std::string digits;
  for (const std::uint64_t part : agreement.parts) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(part));
    digits += text;
  }
  return digits;
}

/// The `links.port` that its ports follow from: a node that is not ours knows no other.
int common_port(const config::RingConfig& ring) {
  const int first = ring.nodes.front().link.port - ring.nodes.front().id;
  for (const config::NodeConfig& node : ring.nodes)
    if (node.link.transport != config::LinkConfig::Transport::udp || node.link.port - node.id != first)
      throw UsageError("--foreign: node '" + node.name + "' does not listen over UDP at links.port + its id; leave " +
                       "`transport` and `port` of its link to `links`: {transport: udp, port: 17000}");
  return first;
}

/// What a node is told that reads no YAML: RING NODE PORT IDS AGREEMENT.
int tell_foreign(const std::vector<std::string>& files, const std::string& name) {
  if (files.size() != 1) throw UsageError("--foreign: it is of one ring; name one FILE");
  const config::RingConfig ring = config::load_ring(app::ring_file(files.front()));
  const config::NodeConfig* node = ring.find(name);
  if (!node) {
    std::vector<NodeName> there;
    for (const config::NodeConfig& each : ring.nodes) there.push_back({each.id, each.name});
    throw unknown_node(name, ring.ring, there);
  }
  std::string ids;
  for (const config::NodeConfig& each : ring.nodes) ids += (ids.empty() ? "" : ",") + std::to_string(each.id);
  const int port = common_port(ring);
  std::cout << ring.ring << ' ' << +node->id << ' ' << port << ' ' << ids << ' '
            << hexadecimal(setup::agreement_of(ring)) << std::endl;
  return kDone;
}

}  // namespace

void add_check(CLI::App& app, Context& context) {
  auto files = std::make_shared<std::vector<std::string>>();
  CLI::App* command = add_command(app, "check", "Check files of rings, scenarios and robots", "ringctl check leg8.yaml",
                                  "Starts nothing, and prints all errors at once. 'ring_sim plan' says whether the "
                                  "ring carries its packets in time.");
  command->add_option("FILE", *files, "YAML of a ring or scenario, the name of a ring such as leg8, or a URDF")
      ->required();
  auto foreign = std::make_shared<std::string>();
  command
      ->add_option("--foreign", *foreign,
                   "Print instead what the program of NODE needs to know if it is not ringd: the ring's name, the id, "
                   "links.port, all ids, and the agreement of protocol.md section 6.13")
      ->type_name("NODE");
  command->callback([&context, files, foreign] {
    context.action = [files, foreign] { return foreign->empty() ? check(*files) : tell_foreign(*files, *foreign); };
  });
}

}  // namespace limb_ring::ringctl
