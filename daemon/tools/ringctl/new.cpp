// ringctl new: the file of a ring for a robot of which there is a URDF, and a catkin package around it.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "config/entry.h"
#include "config/load_ring.h"
#include "config/quantity.h"
#include "config/ring_config.h"
#include "config/urdf_joints.h"
#include "sim/planned_ring.h"
#include "study/plan.h"
#include "tools/common/ring_file.h"
#include "tools/ringctl/command_line.h"
#include "tools/ringctl/screen.h"

namespace limb_ring::ringctl {

/// A node of a ring that `ringctl new` writes.
struct NewNode {
  std::string name;
  std::vector<std::string> joints;                ///< as the URDF has them
  std::vector<std::string> cpu{"limb_firmware"};  ///< program and arguments
};

struct NewRing {
  std::string name, robot;
  std::string urdf;            ///< from the folder of the ring's file
  std::string package;         ///< empty: none
  double rate = 100;           ///< Hz
  std::vector<NewNode> nodes;  ///< without the body
};

/// The first nodes get programs of the package as their CPUs: one in C++, and if there are two nodes, one in Python.
void give_own_firmware(NewRing& ring);
/// All files of the package but the ring's and the URDF: path and text.
std::vector<std::pair<std::string, std::string>> package_files(const NewRing& ring);
/// What to type next.
std::string next_of(const NewRing& ring);

namespace {

namespace fs = std::filesystem;
using config::UrdfJoint;
using config::UrdfJoints;

constexpr std::size_t kMostJointsOfANode = 32;

struct NewOptions {
  std::string urdf, file, name, package;
  std::size_t per_node = 3;
  bool per_chain = false, force = false;
  double rate = 100;
};

/// Letters, digits and '_' of a name, beginning with a letter; at most 32 characters.
std::string plain_name(const std::string& text, const std::string& fallback) {
  std::string name;
  for (const char c : text) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (letter || (!name.empty() && ((c >= '0' && c <= '9') || c == '_')))
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  for (const char* end : {"_link", "_Link", "_LINK"})
    if (const std::size_t size = std::string(end).size(); name.size() > size && name.substr(name.size() - size) == end)
      name.resize(name.size() - size);
  return name.empty() ? fallback : name.substr(0, 32);
}

/// The joints with a motor along the robot's kinematic chains: a chain ends where the robot branches.
class Chains {
 public:
  explicit Chains(const UrdfJoints& urdf) : urdf_(urdf) {
    std::set<std::string> children;
    for (const std::string& name : urdf.order) {
      const UrdfJoint& joint = urdf.joints.at(name);
      below_[joint.parent].push_back(name);
      children.insert(joint.child);
    }
    for (const std::string& name : urdf.order) {
      const std::string& root = urdf.joints.at(name).parent;
      if (children.count(root) == 0 && seen_.insert(root).second) follow(root, 0);
    }
    for (const std::string& name : urdf.order)  // a loop has no root
      if (urdf.joints.at(name).has_motor() && taken_.count(name) == 0) take(name, 0);
    chains_.erase(std::remove_if(chains_.begin(), chains_.end(), [](const auto& chain) { return chain.empty(); }),
                  chains_.end());
  }

  const std::vector<std::vector<std::string>>& all() const { return chains_; }

 private:
  bool leads_to_motors(const std::string& joint, std::size_t depth = 0) const {
    const UrdfJoint& one = urdf_.joints.at(joint);
    if (one.has_motor()) return true;
    const auto below = below_.find(one.child);
    return below != below_.end() && depth <= urdf_.joints.size() &&
           std::any_of(below->second.begin(), below->second.end(),
                       [&](const std::string& next) { return leads_to_motors(next, depth + 1); });
  }

  void take(const std::string& joint, std::size_t chain) {
    if (chains_.size() <= chain) chains_.resize(chain + 1);
    chains_[chain].push_back(joint);
    taken_.insert(joint);
  }

  /// @param chain that leads to this link; if the link branches, each branch is a new one
  void follow(const std::string& link, std::size_t chain) {
    const auto below = below_.find(link);
    if (below == below_.end()) return;
    std::vector<std::string> on;
    for (const std::string& joint : below->second)
      if (leads_to_motors(joint) && seen_.insert("joint " + joint).second) on.push_back(joint);
    for (const std::string& joint : on) {
      const std::size_t next = on.size() == 1 ? chain : std::max<std::size_t>(chains_.size(), 1);
      if (urdf_.joints.at(joint).has_motor())
        take(joint, next);
      else if (chains_.size() <= next)
        chains_.resize(next + 1);
      follow(urdf_.joints.at(joint).child, next);
    }
  }

  const UrdfJoints& urdf_;
  std::map<std::string, std::vector<std::string>> below_;  ///< joints by their parent link
  std::set<std::string> seen_, taken_;
  std::vector<std::vector<std::string>> chains_;
};

std::vector<NewNode> nodes_of(const UrdfJoints& urdf, const NewOptions& options) {
  const std::size_t most = options.per_chain ? kMostJointsOfANode : options.per_node;
  std::vector<NewNode> nodes;
  std::set<std::string> names{"body", "all"};
  const Chains chains(urdf);
  for (const auto& chain : chains.all()) {
    // As even as can be: 4 joints by 3 are 2 and 2.
    const std::size_t parts = (chain.size() + most - 1) / most;
    for (std::size_t part = 0, begin = 0; part < parts; ++part) {
      const std::size_t end = chain.size() * (part + 1) / parts;
      NewNode node;
      node.joints.assign(chain.begin() + static_cast<std::ptrdiff_t>(begin),
                         chain.begin() + static_cast<std::ptrdiff_t>(end));
      begin = end;
      const std::string stem = plain_name(urdf.joints.at(node.joints[0]).child, "node");
      node.name = stem;
      for (int i = 2; !names.insert(node.name).second; ++i) node.name = stem.substr(0, 29) + '_' + std::to_string(i);
      nodes.push_back(node);
    }
  }
  return nodes;
}

/// As a plain value of YAML, or quoted.
std::string yaml_word(const std::string& text) {
  const bool plain = config::is_node_name(text) && text != "null" && text != "Null" && text != "NULL";
  return plain ? text : '"' + text + '"';
}

std::string node_text(const NewNode& node, std::size_t id) {
  std::string text = "  - id: " + std::to_string(id) + "\n    name: " + node.name + "\n    cpu: {command: [" +
                     config::join(node.cpu) + "], alive_period: 200ms}\n    joints:\n";
  for (const std::string& joint : node.joints) text += "      - {name: " + yaml_word(joint) + "}\n";
  return text;
}

std::string ring_text(const NewRing& ring) {
  std::string text =
      "# The ring of " + ring.robot +
      ", written by 'ringctl new'. Every entry that may stand here: ringd --options.\n"
      "# Types and limits of the joints are the URDF's; what stands here with a joint goes before: lower, upper,\n"
      "# velocity, effort, initial, safe: hold or damp.\n"
      "ring: " +
      ring.name + "\nurdf: " + yaml_word(ring.urdf) +
      "\n\n"
      "firmware: {state_rate: " +
      config::format_real(ring.rate) +
      "}   # Hz: each node sends the state of its joints\n"
      "bridge:\n  rate: " +
      config::format_real(ring.rate) +
      "   # Hz of joint_states\n"
      "  broadcast_commands: true   # one packet for the commands of all nodes\n\n"
      "nodes:   # in ring order: each sends to the next, the last to the first\n"
      "  - {id: 0, name: body, cpu: attached, receive_buffers: 512}   # ring_bridge connects\n";
  for (std::size_t i = 0; i < ring.nodes.size(); ++i) text += node_text(ring.nodes[i], i + 1);
  return text;
}

void write(const fs::path& path, const std::string& text, bool force) {
  std::error_code error;
  if (!force && fs::exists(path, error))
    throw UsageError(path.string() + " already exists and was not changed; --force overwrites it");
  if (const std::string problem =
          app::make_output_folder(path.parent_path().empty() ? "." : path.parent_path().string());
      !problem.empty())
    throw UsageError(problem);
  std::ofstream file;
  if (const std::string problem = app::open_for_writing(file, path.string()); !problem.empty())
    throw UsageError(problem);
  file << text;
  file.close();
  if (!file) throw NotDone(path.string() + " cannot be written");
}

void print_nodes(const NewRing& ring, const config::RingConfig& config) {
  std::cout << "ring " << ring.name << ", " << config.nodes.size() << " nodes in this order:\n  body: ring_bridge, or "
            << "another program that connects as its CPU\n";
  for (const NewNode& node : ring.nodes) std::cout << "  " << node.name << ": " << config::join(node.joints) << '\n';
  for (const auto& follower : config.followers)
    std::cout << "  " << follower.name << " follows " << follower.leader << ", without a motor\n";
}

void print_plan(const config::RingConfig& config) {
  const config::RingConfig ring = sim::with_assumed_lines(config, sim::kUsualRate, sim::kUsualRelayDelay);
  std::cout << "With lines of " << config::format_rate(sim::kUsualRate) << ": "
            << study::verdict(ring, study::plan(ring, study::streams_of(ring)));
}

/// The joints that no ring can drive.
void print_left_out(const UrdfJoints& urdf) {
  std::vector<std::string> left;
  for (const std::string& name : urdf.order)
    if (const std::string& type = urdf.joints.at(name).type; type == "floating" || type == "planar")
      left.push_back(name + " (" + type + ")");
  if (!left.empty())
    std::cout << "left out, because a ring drives only joints with one axis: " << config::join(left) << '\n';
}

int make(const NewOptions& options) {
  const UrdfJoints urdf = config::parse_urdf(config::read_file(options.urdf), options.urdf, /*whole=*/true);
  NewRing ring;
  ring.robot = urdf.robot.empty() ? fs::path(options.urdf).filename().string() : urdf.robot;
  ring.name = options.name.empty() ? plain_name(ring.robot, "robot") : options.name;
  if (!config::is_ring_name(ring.name))
    throw UsageError("--name: '" + ring.name + "' is not a ring name; allowed: " + config::kRingNameRule);
  ring.package = options.package;
  ring.rate = options.rate;
  ring.nodes = nodes_of(urdf, options);
  if (ring.nodes.empty())
    throw UsageError(options.urdf + " has no joint with a motor: none is revolute, continuous or prismatic");
  if (ring.nodes.size() + 1 > config::kMostNodes)
    throw UsageError("that would be " + std::to_string(ring.nodes.size() + 1) + " nodes; allowed: " +
                     std::to_string(config::kMostNodes) + ", with a larger --per-node or --per-chain");
  fs::path file = options.file.empty() ? ring.name + ".yaml" : options.file;
  if (options.package.empty()) {
    std::error_code error;
    const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
    ring.urdf = fs::proximate(options.urdf, folder, error).string();
  } else {
    const fs::path folder = options.package;
    file = folder / "config" / (ring.name + ".yaml");
    ring.urdf = "../urdf/" + fs::path(options.urdf).filename().string();
    give_own_firmware(ring);
    std::vector<std::pair<fs::path, std::string>> all{
        {folder / "urdf" / fs::path(options.urdf).filename(), config::read_file(options.urdf)}};
    for (const auto& [path, text] : package_files(ring)) all.emplace_back(folder / path, text);
    std::error_code error;
    for (const auto& [path, text] : all)
      if (!options.force && fs::exists(path, error))
        throw UsageError(path.string() + " already exists, and nothing was written; --force overwrites it");
    for (const auto& [path, text] : all) write(path, text, options.force);
    for (const auto& [path, text] : all)
      if (text.compare(0, 2, "#!") == 0)
        fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                        fs::perm_options::add, error);
  }
  const std::string text = ring_text(ring);
  const config::RingConfig config = config::parse_ring(text, file.string());
  write(file, text, options.force);
  for (const std::string& warning : config.warnings) tell_user("warning: " + warning);
  std::cout << "wrote "
            << (options.package.empty() ? file.string()
                                        : "the package " + options.package + " and its " + file.string())
            << ": ";
  print_nodes(ring, config);
  print_left_out(urdf);
  print_plan(config);
  std::cout << "Next: " << (options.package.empty() ? "ringctl up " + file.string() : next_of(ring)) << std::endl;
  return kDone;
}

}  // namespace

void add_new(CLI::App& app, Context& context) {
  auto options = std::make_shared<NewOptions>();
  CLI::App* command =
      add_command(app, "new", "Write a ring's file, or a package, for a robot", "ringctl new robot.urdf",
                  "The nodes follow the robot's kinematic chains and are named after its links. limb_firmware is their "
                  "CPU. --package writes a catkin package around the ring.");
  command->add_option("ROBOT.urdf", options->urdf, "The robot's description; limits are read from it")->required();
  command->add_option("-o,--output", options->file, "The file to write; default: NAME.yaml in this folder");
  command->add_option("--name", options->name, "Name of the ring; default: the robot's");
  command->add_option("--per-node", options->per_node, "Most joints per node, 1 to 32; default 3")
      ->check(CLI::Range(std::size_t{1}, kMostJointsOfANode));
  command->add_flag("--per-chain", options->per_chain, "One node for each kinematic chain")->excludes("--per-node");
  command->add_option("--rate", options->rate, "Rate of joint states in Hz, 1 to 1000; default 100")
      ->check(CLI::Range(1.0, 1000.0));
  command
      ->add_option("--package", options->package,
                   "Write a catkin package of this name into a folder of this name: the ring, launch files, firmware "
                   "of one node in C++ and of one in Python, a controller and three kinds of test")
      ->excludes("--output");
  command->add_flag("--force", options->force, "Overwrite existing files");
  command->callback([&context, options] { context.action = [options] { return make(*options); }; });
}

namespace {

constexpr const char* kPackageXml = R"file(<?xml version="1.0"?>
<package format="2">
  <name>@PACKAGE@</name>
  <version>0.0.1</version>
  <description>@ROBOT@ on a ring: its firmware, a controller and tests</description>
  <maintainer email="you@example.com">you</maintainer>
  <license>TODO</license>
  <buildtool_depend>catkin</buildtool_depend>
  <depend>limb_ring</depend>
  <exec_depend>python3-yaml</exec_depend>
  <exec_depend>robot_state_publisher</exec_depend>
  <exec_depend>rospy</exec_depend>
  <exec_depend>rviz</exec_depend>
  <exec_depend>sensor_msgs</exec_depend>
  <test_depend>python3-pytest</test_depend>
  <test_depend>rostest</test_depend>
</package>
)file";

constexpr const char* kCMake = R"file(cmake_minimum_required(VERSION 3.16)
project(@PACKAGE@ CXX)
find_package(catkin REQUIRED COMPONENTS limb_ring)
catkin_package()

add_executable(@FIRST@_cpu src/@FIRST@_cpu.cpp)
target_link_libraries(@FIRST@_cpu PRIVATE limb_ring::limb_ring)
set_target_properties(@FIRST@_cpu PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})

install(TARGETS @FIRST@_cpu RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
catkin_install_python(PROGRAMS @SCRIPTS@ DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY config launch urdf DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})

# ctest, in an environment that knows this package (. devel/setup.sh), runs all three kinds.
if(CATKIN_ENABLE_TESTING)
  find_package(rostest REQUIRED)
  add_rostest(test/moves.test)
  add_test(NAME pytest COMMAND ${PYTHON_EXECUTABLE} -m pytest -p no:cacheprovider ${CMAKE_CURRENT_SOURCE_DIR}/test)
  add_test(NAME scenario COMMAND ringctl scenario run ${CMAKE_CURRENT_SOURCE_DIR}/test/hang.yaml)
endif()
)file";

constexpr const char* kLaunch = R"file(<launch>
  <!-- roslaunch @PACKAGE@ @RING@.launch    the ring, the robot in RViz, and a controller that waves all joints -->
  <arg name="view" default="true" doc="show the robot in RViz"/>
  <arg name="wave" default="true" doc="start the controller"/>
  <arg name="clock" default="machine" doc="machine or virtual, as limb_ring's ring.launch"/>
  <node if="$(arg wave)" name="wave" pkg="@PACKAGE@" type="wave.py" output="screen"/>
  <include file="$(find limb_ring)/launch/ring.launch">
    <arg name="config" value="$(find @PACKAGE@)/config/@RING@.yaml"/>
    <arg name="clock" value="$(arg clock)"/>
    <arg name="view" value="$(arg view)"/>
    <arg name="description" value="$(find @PACKAGE@)/urdf/@URDF@"/>
  </include>
</launch>
)file";

constexpr const char* kCpp =
    R"file(// The firmware of node @FIRST@. What a CPU owes its ring is kept by JointNode; how the joints move is yours.
#include <limb_ring/joint_node.h>

#include <iostream>
#include <string>
#include <utility>
#include <vector>

int main(int argc, char** argv) try {
  limb_ring::JointNode node = limb_ring::JointNode::connect(argc, argv);
  auto joints = node.joints();  // position, velocity and effort of each; limits are in node.setup()
  node.on_step([&](double dt, const std::vector<limb_ring::JointGoal>& goals) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (!goals[i].position) continue;  // damp, or commanded by velocity or effort alone
      const double velocity = (*goals[i].position - joints[i].position) * 10;  // a tenth of a second behind
      joints[i] = {joints[i].position + velocity * dt, velocity, 0};
    }
    return joints;
  });
  return node.run();
} catch (const std::exception& problem) {
  std::cerr << "@FIRST@_cpu: " << problem.what() << std::endl;
  return 1;
}
)file";

constexpr const char* kPython = R"file(#!/usr/bin/python3
"""The firmware of node @SECOND@. What a CPU owes its ring is kept by JointNode; how the joints move is yours."""
import sys

import limb_ring

node = limb_ring.JointNode.of_arguments()
positions = [joint.initial for joint in node.joints]   # limits are in node.joints, too

def step(dt, goals):
    for i, goal in enumerate(goals):
        if goal.position is not None:   # None: damp, or commanded by velocity or effort alone
            positions[i] += (goal.position - positions[i]) * 10 * dt   # a tenth of a second behind
    return positions

sys.exit(node.run(step))
)file";

constexpr const char* kWave = R"file(#!/usr/bin/python3
"""Waves all joints of the ring: answers each joint_states with joint_commands of the same stamp."""
import math
import os

import rospkg
import rospy
import yaml
from sensor_msgs.msg import JointState

with open(os.path.join(rospkg.RosPack().get_path('@PACKAGE@'), 'config', '@RING@.yaml')) as file:
    JOINTS = {joint['name'] for node in yaml.safe_load(file)['nodes'] for joint in node.get('joints', [])}
start = {}   # position of each joint when it was heard first

def answer(states):
    for name, position in zip(states.name, states.position):
        if name in JOINTS:   # others follow, without a motor
            start.setdefault(name, position)
    swing = 0.2 * math.sin(math.pi * states.header.stamp.to_sec())   # rad or m; firmware keeps to the limits
    command = JointState(name=list(start), position=[position + swing for position in start.values()])
    command.header.stamp = states.header.stamp
    commands.publish(command)

rospy.init_node('wave')
commands = rospy.Publisher('joint_commands', JointState, queue_size=1)
rospy.Subscriber('joint_states', JointState, answer, tcp_nodelay=True)
rospy.spin()
)file";

constexpr const char* kRostest = R"file(<launch>
  <include file="$(find @PACKAGE@)/launch/@RING@.launch">
    <arg name="view" value="false"/>
  </include>
  <test test-name="moves" pkg="@PACKAGE@" type="moves.py" time-limit="90"/>
</launch>
)file";

constexpr const char* kRostestPython = R"file(#!/usr/bin/python3
"""With ROS: every node has joints that move."""
import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState

ONE_OF_EACH_NODE = @ONE_OF_EACH@

class Moves(unittest.TestCase):
    def test_a_joint_of_each_node_is_moved_by_the_controller(self):
        least, most = {}, {}

        def note(states):
            for name, position in zip(states.name, states.position):
                least[name] = min(position, least.get(name, position))
                most[name] = max(position, most.get(name, position))
        rospy.Subscriber('joint_states', JointState, note)
        still = ONE_OF_EACH_NODE
        while still and not rospy.is_shutdown():   # the time limit of the test ends it
            still = [name for name in ONE_OF_EACH_NODE if most.get(name, 0) - least.get(name, 0) < 0.001]
            rospy.sleep(0.1)
        self.assertEqual(still, [])

if __name__ == '__main__':
    rospy.init_node('moves')
    rostest.rosrun('@PACKAGE@', 'moves', Moves)
)file";

constexpr const char* kPytest =
    R"file("""Without ROS, on a clock of the ring's own: the firmware of the package obeys, and goes to its safe state."""
import limb_ring
import pytest

NODES = @OWN_NODES@

@pytest.mark.parametrize('node', NODES)
@pytest.mark.ring('../config/@RING@.yaml', clock='virtual')
def test_a_node_obeys_commands_and_is_safe_without_them(ring, node):
    number = ring.id_of(node)
    with ring.port('body', role='cpu', lockstep=True) as body:
        def state(wanted):
            def is_it(message):
                return (isinstance(message, limb_ring.Packet) and message.source == number
                        and isinstance(message.payload, limb_ring.JointState) and wanted(message.payload))
            return body.find(is_it, timeout=5).payload

        there = state(lambda state: state.mode.safe)
        goal = limb_ring.JointCommand([limb_ring.JointCommand.Joint(position=there.joints[0].position)], valid_for=0.1)
        assert body.wait(body.send(number, goal), timeout=2).outcome == 'delivered'
        state(lambda state: state.mode.commanded)
        state(lambda state: not state.mode.commanded)   # 200 ms later: timeouts.command
)file";

constexpr const char* kScenario = R"file(# The CPU of @FIRST@ hangs, and a reset through the ring brings it back.
scenario: a hung CPU comes back
ring: ../config/@RING@.yaml
steps:
  - at: 20ms
    do: {hang: @FIRST@}
  - after: 10ms
    do: {reset: @FIRST@}
  - when: {cpu: @FIRST@, is: running, boots: 2}
    within: {sim: 1s, live: 5s}
always:
  - {counter: crc_errors, of: all, at_most: 0}
)file";

std::string filled(std::string text, const std::vector<std::pair<std::string, std::string>>& values) {
  for (const auto& [name, value] : values)
    for (std::size_t at = 0; (at = text.find('@' + name + '@', at)) != std::string::npos; at += value.size())
      text.replace(at, name.size() + 2, value);
  return text;
}

std::string python_list(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "'" : ", '") + word + "'";
  return '[' + list + ']';
}

}  // namespace

void give_own_firmware(NewRing& ring) {
  ring.nodes[0].cpu = {"rosrun", ring.package, ring.nodes[0].name + "_cpu"};
  if (ring.nodes.size() > 1) ring.nodes[1].cpu = {"rosrun", ring.package, ring.nodes[1].name + "_cpu.py"};
}

std::vector<std::pair<std::string, std::string>> package_files(const NewRing& ring) {
  const std::string first = ring.nodes[0].name, second = ring.nodes.size() > 1 ? ring.nodes[1].name : "";
  std::vector<std::string> one_of_each, own{first};
  for (const NewNode& node : ring.nodes) one_of_each.push_back(node.joints[0]);
  if (!second.empty()) own.push_back(second);
  const std::string script = second.empty() ? "" : "scripts/" + second + "_cpu.py";
  const std::vector<std::pair<std::string, std::string>> values{
      {"PACKAGE", ring.package},
      {"RING", ring.name},
      {"ROBOT", ring.robot},
      {"URDF", ring.urdf.substr(ring.urdf.rfind('/') + 1)},
      {"FIRST", first},
      {"SECOND", second},
      {"SCRIPTS", "scripts/wave.py" + (second.empty() ? "" : ' ' + script)},
      {"ONE_OF_EACH", python_list(one_of_each)},
      {"OWN_NODES", python_list(own)}};
  std::vector<std::pair<std::string, std::string>> files{{"package.xml", kPackageXml},
                                                         {"CMakeLists.txt", kCMake},
                                                         {"launch/" + ring.name + ".launch", kLaunch},
                                                         {"src/" + first + "_cpu.cpp", kCpp},
                                                         {"scripts/wave.py", kWave},
                                                         {"test/moves.test", kRostest},
                                                         {"test/moves.py", kRostestPython},
                                                         {"test/test_firmware.py", kPytest},
                                                         {"test/hang.yaml", kScenario}};
  if (!second.empty()) files.emplace_back(script, kPython);
  for (auto& [path, text] : files) text = filled(text, values);
  return files;
}

std::string next_of(const NewRing& ring) {
  return "build it in a catkin workspace, then roslaunch " + ring.package + ' ' + ring.name + ".launch";
}

}  // namespace limb_ring::ringctl
