#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "config/ring_text.h"
#include "support/temporary_folder.h"

namespace limb_ring::config {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A robot of two links, and this in it. What is added begins in line 2.
std::string robot(const std::string& joints) { return "<robot name='r'>\n" + joints + "</robot>\n"; }

std::string knee(const std::string& type, const std::string& limit) {
  return robot("<joint name='knee' type='" + type + "'>" + limit + "</joint>\n");
}

/// A ring with the joint knee of robot.urdf, and `more` among its entries, from line 5 on.
std::string ring_of(const std::string& more = "") {
  return "ring: r\n"
         "urdf: robot.urdf\n"
         "nodes:\n"
         "  - {id: 0, cpu: attached, joints: [{name: knee" +
         more + "}]}\n  - {id: 1}\n";
}

class Urdf : public ::testing::Test {
 protected:
  void write(const std::string& urdf) const { temporary_.write("robot.urdf", urdf); }
  RingConfig load(const std::string& ring) const { return parse_ring(ring, folder_ + "/ring.yaml"); }
  JointConfig joint(const std::string& urdf, const std::string& more = "") const {
    write(urdf);
    return load(ring_of(more)).nodes.at(0).joints.at(0);
  }
  std::string refusal(const std::string& urdf, const std::string& ring = ring_of()) const {
    write(urdf);
    try {
      load(ring);
      return {};
    } catch (const ConfigError& error) {
      return error.what();
    }
  }

  test::TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(Urdf, GivesTheLimitsOfItsJoints) {
  const JointConfig joint = this->joint(knee("revolute", "<limit lower='-2' upper='0.5' velocity='7' effort='90'/>"));
  EXPECT_EQ(joint.lower, -2);
  EXPECT_EQ(joint.upper, 0.5);
  EXPECT_EQ(joint.velocity, 7);
  EXPECT_EQ(joint.effort, 90);
}

TEST_F(Urdf, GivesWayToALimitInTheRingsFile) {
  const JointConfig joint = this->joint(knee("revolute", "<limit lower='-2' upper='0.5' velocity='0' effort='90'/>"),
                                        ", lower: -1, velocity: 3");
  EXPECT_EQ(joint.lower, -1);
  EXPECT_EQ(joint.upper, 0.5);
  EXPECT_EQ(joint.velocity, 3);
}

TEST_F(Urdf, SaysThatAContinuousJointHasNoLimitsOfItsAngle) {
  const JointConfig joint = this->joint(knee("continuous", "<limit velocity='7' effort='90'/>"));
  EXPECT_EQ(joint.lower, -100);
  EXPECT_EQ(joint.upper, 100);
}

TEST_F(Urdf, OfTheHumanoidGivesWhatItsRingSays) {
  const std::string shipped = std::string(SHIPPED_CONFIG) + "/humanoid16.yaml";
  const RingConfig ring = load_ring(shipped);
  std::string text = "ring: r\nurdf: " + std::string(SHIPPED_CONFIG) + "/../urdf/humanoid16.urdf\nnodes:\n";
  for (const auto& node : ring.nodes) {
    text += "  - id: " + std::to_string(node.id) + "\n    cpu: attached\n    joints:";
    if (node.joints.empty()) text += " []";
    text += '\n';
    for (const auto& joint : node.joints)
      text += "      - {name: " + joint.name + ", initial: " + std::to_string(joint.initial) + "}\n";
  }
  const RingConfig by_urdf = load(text);
  for (std::size_t n = 0; n < ring.nodes.size(); ++n)
    for (std::size_t i = 0; i < ring.nodes[n].joints.size(); ++i) {
      const JointConfig &there = ring.nodes[n].joints[i], &here = by_urdf.nodes[n].joints[i];
      EXPECT_EQ(here.lower, there.lower) << there.name;
      EXPECT_EQ(here.upper, there.upper) << there.name;
      EXPECT_EQ(here.velocity, there.velocity) << there.name;
      EXPECT_EQ(here.effort, there.effort) << there.name;
    }
}

TEST_F(Urdf, IsFoundInAPackage) {
  std::filesystem::create_directory(folder_ + "/my_robot");
  std::ofstream(folder_ + "/my_robot/package.xml") << "<package/>";
  std::ofstream(folder_ + "/my_robot/robot.urdf") << knee("continuous", "<limit velocity='7' effort='90'/>");
  std::string ring = ring_of();
  ring.replace(ring.find("robot.urdf"), 10, "package://my_robot/robot.urdf");
  for (const std::string& folders : {"/nowhere:" + folder_, "/nowhere:" + folder_ + "/my_robot"}) {
    ::setenv("ROS_PACKAGE_PATH", folders.c_str(), 1);
    EXPECT_EQ(load(ring).nodes[0].joints[0].velocity, 7) << folders;
  }
  ::setenv("ROS_PACKAGE_PATH", "/nowhere", 1);
  EXPECT_THAT(refusal("", ring),
              HasSubstr("no folder of ROS_PACKAGE_PATH has the package 'my_robot'; allowed: a URDF"));
  ::unsetenv("ROS_PACKAGE_PATH");
  EXPECT_THAT(refusal("", ring), HasSubstr("ROS_PACKAGE_PATH is not set"));
}

TEST_F(Urdf, IsNotThereOrNoUrdf) {
  const std::string place = folder_ + "/ring.yaml:2:7: entry 'urdf': " + folder_ + "/robot.urdf";
  EXPECT_THAT(refusal_of(ring_of()), AllOf(HasSubstr("entry 'urdf': robot.urdf: there is no such file"),
                                           EndsWith("allowed: a URDF: its path from the folder of this file, or "
                                                    "absolute, or package://PACKAGE/PATH")));
  EXPECT_THAT(refusal("<robot>\n<joint>\n"), StartsWith(place + ":2: is not XML: XML_ERROR_"));
  EXPECT_THAT(refusal("<sdf/>"), StartsWith(place + ":1: is no URDF: its root is <sdf>; allowed: <robot>"));
  EXPECT_THAT(refusal(""), HasSubstr("is not XML: XML_ERROR_EMPTY_DOCUMENT"));
  EXPECT_THAT(refusal(robot("<joint type='fixed'/>\n")), StartsWith(place + ":2: a joint has no name"));
  EXPECT_THAT(refusal(robot("<joint name='a' type='fixed'/>\n<joint name='a' type='fixed'/>\n")),
              StartsWith(place + ":3: joint 'a' is there twice, first in line 2"));
}

TEST_F(Urdf, HasNoSuchJoint) {
  EXPECT_THAT(refusal(robot("<joint name='knees' type='revolute'/>\n<joint name='mount' type='fixed'/>\n")),
              AllOf(StartsWith(folder_ + "/ring.yaml:4:"),
                    HasSubstr("entry 'nodes[0].joints[0].name': there is no joint "
                              "'knee' in " +
                              folder_ + "/robot.urdf, did you mean 'knees'?"),
                    EndsWith("allowed: knees")));
  EXPECT_THAT(refusal(robot("")), HasSubstr("none is revolute or continuous"));
}

TEST_F(Urdf, HasAJointThatDoesNotTurn) {
  for (const char* type : {"fixed", "prismatic", "floating", "planar"})
    EXPECT_THAT(refusal(knee(type, "")), HasSubstr(std::string("joint 'knee' is ") + type + " in " + folder_ +
                                                   "/robot.urdf:2; allowed: a joint that is revolute or continuous"));
}

TEST_F(Urdf, HasALimitThatIsMissingOrWrong) {
  EXPECT_THAT(refusal(knee("revolute", "")), HasSubstr("entry 'nodes[0].joints[0]': joint 'knee' has no lower in "));
  EXPECT_THAT(refusal(knee("continuous", "")), HasSubstr("joint 'knee' has no velocity in "));
  EXPECT_THAT(refusal(knee("revolute", "<limit upper='1' velocity='0' effort='9'/>")),
              HasSubstr("joint 'knee' has velocity=\"0\" in " + folder_ +
                        "/robot.urdf:2; allowed: a number, 0.001 to 1000 rad/s, there or as 'velocity' here"));
  EXPECT_THAT(refusal(knee("revolute", "<limit lower='${-pi}' upper='1' velocity='1' effort='9'/>")),
              HasSubstr("has lower=\"${-pi}\" in "));
  EXPECT_THAT(refusal(knee("revolute", "<limit velocity='1' effort='9'/>")),
              HasSubstr("joint 'knee' has the limits 0 to 0 rad"));
  EXPECT_THAT(refusal(knee("revolute", "<limit lower='1' upper='2' velocity='1' effort='9'/>")),
              HasSubstr("joint 'knee' has initial 0, outside its limits; allowed: 1 to 2 rad"));
}

}  // namespace
}  // namespace limb_ring::config
