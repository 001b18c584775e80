#include "tools/ringctl/command/new_package.h"

namespace limb_ring::ringctl {

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
