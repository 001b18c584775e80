#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "config/ring_text.h"
#include "config/urdf_joints.h"
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
  for (const char* limit :
       {"<limit velocity='7' effort='90'/>", "<limit lower='-1' upper='1' velocity='7' effort='90'/>"}) {
    const JointConfig joint = this->joint(knee("continuous", limit));
    EXPECT_EQ(joint.type, JointConfig::Type::continuous);
    EXPECT_EQ(joint.lower, -2147);
    EXPECT_EQ(joint.upper, 2147);
  }
  EXPECT_EQ(load(ring_of()).warnings.size(), 0u);
}

TEST_F(Urdf, HasJointsThatSlide) {
  const JointConfig lift = joint(knee("prismatic", "<limit lower='0.1' upper='0.35' velocity='0.07' effort='2000'/>"));
  EXPECT_TRUE(lift.slides());
  EXPECT_EQ(lift.upper, 0.35);
  EXPECT_EQ(lift.velocity, 0.07);
  EXPECT_EQ(lift.initial, 0.1);
  EXPECT_EQ(joint(knee("prismatic", ""), "").upper, 1) << "as if the ring's file had said so";
  EXPECT_THAT(refusal(knee("prismatic", ""), ring_of(", type: revolute")),
              HasSubstr("'revolute' is another type than in"));
}

TEST_F(Urdf, StartsAJointAsCloseToZeroAsItsLimitsAllow) {
  EXPECT_EQ(joint(knee("revolute", "<limit lower='1' upper='2' velocity='1' effort='9'/>")).initial, 1);
  EXPECT_EQ(joint(knee("revolute", "<limit lower='-2' upper='-1' velocity='1' effort='9'/>")).initial, -1);
  EXPECT_EQ(joint(knee("revolute", "<limit lower='-2' upper='1' velocity='1' effort='9'/>")).initial, 0);
}

TEST_F(Urdf, ThatLeavesLimitsOpenIsTakenWithOneWarningThatNamesTheJoints) {
  write(
      robot("<joint name='a' type='revolute'><limit lower='-1' upper='1' velocity='0' effort='0'/></joint>\n"
            "<joint name='b' type='prismatic'><limit lower='-1' upper='1' velocity='2'/></joint>\n"
            "<joint name='c' type='continuous'/>\n<joint name='d' type='revolute'/>\n"
            "<joint name='e' type='revolute'><limit lower='-9e9' upper='1' velocity='1' effort='1e9'/></joint>\n"
            "<joint name='f' type='revolute'><limit lower='2' upper='2' velocity='1' effort='1'/></joint>\n"));
  const RingConfig ring = load(
      "ring: r\nurdf: robot.urdf\nnodes:\n  - {id: 0, cpu: attached, joints: [{name: a}, {name: b}, {name: c}, {name: "
      "d, "
      "effort: 3}, {name: e}, {name: f}]}\n  - {id: 1}\n");
  ASSERT_EQ(ring.warnings.size(), 1u);
  EXPECT_EQ(
      ring.warnings[0],
      folder_ +
          "/robot.urdf has no effort (taken as 50 N m, or 500 N) for a, b, c; values that do not fit into packets (cut "
          "to 2147 both ways) for e.lower, e.effort; no lower and upper (taken as 3.14 rad, or 1 m both ways) for d; "
          "no "
          "motion, because lower equals upper, for f; no velocity (taken as 6 rad/s, or 1 m/s) for a, c, d. Give them "
          "there, or with the joint in the ring's file");
  const auto& joints = ring.nodes[0].joints;
  EXPECT_EQ(joints[0].effort, 50);
  EXPECT_EQ(joints[1].effort, 500);
  EXPECT_EQ(joints[3].lower, -3.14);
  EXPECT_EQ(joints[4].lower, -2147);
  EXPECT_EQ(joints[5].initial, 2);
}

constexpr const char* kHand =
    "<joint name='knee' type='prismatic'><limit lower='0' upper='0.04' velocity='0.2' effort='20'/></joint>\n"
    "<joint name='left' type='prismatic'><mimic joint='knee' multiplier='-1' offset='0.5'/></joint>\n"
    "<joint name='tip' type='revolute'><mimic joint='left' multiplier='2' offset='1'/></joint>\n"
    "<joint name='other' type='revolute'/>\n"
    "<joint name='toe' type='revolute'><mimic joint='other'/></joint>\n";

TEST_F(Urdf, LetsMimicJointsFollowThoseOfTheRing) {
  write(robot(kHand));
  const RingConfig ring = load(ring_of());
  ASSERT_EQ(ring.followers.size(), 2u) << "toe follows a joint that is not in the ring";
  EXPECT_EQ(ring.followers[0].name, "left");
  EXPECT_EQ(ring.followers[1].leader, "knee");
  EXPECT_EQ(ring.followers[1].multiplier, -2);
  EXPECT_EQ(ring.followers[1].offset, 2);
  std::string mimic = ring_of();
  mimic.replace(mimic.find("knee"), 4, "left");
  EXPECT_THAT(refusal(robot(kHand), mimic), AllOf(HasSubstr("joint 'left' has no motor: it mimics 'knee' in "),
                                                  HasSubstr("robot.urdf:3; allowed: to leave it out")));
  EXPECT_THAT(refusal(robot("<joint name='a' type='revolute'><mimic joint='b'/></joint>\n"
                            "<joint name='b' type='revolute'><mimic joint='a'/></joint>\n"
                            "<joint name='c' type='revolute'><mimic joint='d' multiplier='x'/></joint>\n"
                            "<joint name='e' type='revolute'><mimic joint='f'/></joint>\n")),
              AllOf(HasSubstr("joint 'a' mimics itself"), HasSubstr("\"x\" of a <mimic> is not a number"),
                    HasSubstr("joint 'e' mimics 'f', which is not a joint that moves")));
}

TEST_F(Urdf, MayNameItsJointsAsRosDoes) {
  for (const std::string name : {"8", "left/knee", "_roll", "/arm/a.1-b"}) {
    std::string ring = ring_of();
    ring.replace(ring.find("knee"), 4, name);
    write(robot("<joint name='" + name +
                "' type='revolute'><limit lower='-1' upper='1' velocity='1' effort='1'/></joint>\n"));
    EXPECT_EQ(load(ring).nodes[0].joints[0].name, name);
  }
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

TEST_F(Urdf, ThatIsMissingOrNotAUrdfIsRefused) {
  const std::string place = folder_ + "/ring.yaml:2:7: entry 'urdf': " + folder_ + "/robot.urdf";
  EXPECT_THAT(refusal_of(ring_of()), AllOf(HasSubstr("entry 'urdf': robot.urdf: there is no such file"),
                                           EndsWith("allowed: a URDF: its path from the folder of this file, or "
                                                    "absolute, or package://PACKAGE/PATH")));
  EXPECT_THAT(refusal("<robot>\n<joint>\n"), StartsWith(place + ":2: is not XML: XML_ERROR_"));
  EXPECT_THAT(refusal("<gazebo/>"), StartsWith(place + ":1: is not a URDF: its root is <gazebo>; allowed: <robot>"));
  EXPECT_THAT(refusal(""), HasSubstr("is not XML: XML_ERROR_EMPTY_DOCUMENT"));
  EXPECT_THAT(refusal(robot("<joint type='fixed'/>\n")), StartsWith(place + ":2: a joint has no name"));
  EXPECT_THAT(refusal(robot("<joint name='a' type='fixed'/>\n<joint name='a' type='fixed'/>\n")),
              StartsWith(place + ":3: joint 'a' is there twice, first in line 2"));
  EXPECT_THAT(refusal(robot("<joint type='fixed'/>\n<joint name='a' type='fixed'/>\n<joint name='a' type='fixed'/>\n")),
              AllOf(HasSubstr(":2: a joint has no name"), HasSubstr(":4: joint 'a' is there twice")));
}

TEST_F(Urdf, ThatIsSomethingElseIsNamedWithTheCommandThatHelps) {
  EXPECT_THAT(refusal("<sdf/>"), HasSubstr("robot.urdf:1: is an SDF, Gazebo's format, not a URDF. 'rosrun pysdf"));
  EXPECT_THAT(refusal("<mujoco/>"), HasSubstr("is a MuJoCo model"));
  EXPECT_THAT(refusal("<launch/>"), HasSubstr("'rosparam get /robot_description > robot.urdf'"));
  EXPECT_THAT(refusal("<COLLADA/>"), HasSubstr("'rosrun collada_urdf collada_to_urdf"));
  for (const char* part : {"<xacro:property name='a' value='1'/>", "<joint name='${side}_knee' type='revolute'/>"})
    EXPECT_THAT(refusal(robot(part)), HasSubstr("robot.urdf:2: is a xacro file, which is not expanded yet: "));
  write(robot("<xacro:old_plugin/>\n<joint name='knee' type='revolute'/>\n"));
  EXPECT_EQ(load(ring_of()).nodes[0].joints.size(), 1u) << "a macro that nobody has expanded, and nobody needs";
}

TEST_F(Urdf, HasNoSuchJoint) {
  EXPECT_THAT(refusal(robot("<joint name='knees' type='revolute'/>\n<joint name='mount' type='fixed'/>\n")),
              AllOf(StartsWith(folder_ + "/ring.yaml:4:"),
                    HasSubstr("entry 'nodes[0].joints[0].name': there is no joint "
                              "'knee' in " +
                              folder_ + "/robot.urdf, did you mean 'knees'?"),
                    EndsWith("allowed: knees")));
  EXPECT_THAT(refusal(robot("")), HasSubstr("none is revolute, continuous or prismatic"));
}

TEST_F(Urdf, HasAJointThatDoesNotTurn) {
  for (const char* type : {"fixed", "floating", "planar"})
    EXPECT_THAT(refusal(knee(type, "")),
                HasSubstr(std::string("joint 'knee' is ") + type + " in " + folder_ +
                          "/robot.urdf:2; allowed: a joint that is revolute, continuous or prismatic"));
}

TEST_F(Urdf, SaysAllThatIsWrongAtOnce) {
  EXPECT_THAT(refusal(robot("<joint type='fixed'/>\n<joint name='a' type='wobbly'/>\n<joint name='b'/>\n"
                            "<joint name='c' type='revolute'><mimic joint='d'/></joint>\n")),
              AllOf(HasSubstr(":2: a joint has no name"),
                    HasSubstr(":3: joint 'a' is 'wobbly'; allowed: revolute, continuous, prismatic, fixed"),
                    HasSubstr(":4: joint 'b' is of no type"), HasSubstr(":5: joint 'c' mimics 'd'")));
}

TEST_F(Urdf, OfAWholeRobotHasItsLinksAndItsLimits) {
  const std::string wrong = robot(
      "<link name='body'/><link name='shin'/>\n"
      "<joint name='a' type='revolute'><child link='shin'/></joint>\n"
      "<joint name='b' type='prismatic'><parent link='body'/><child link='foot'/><limit lower='1' upper='0'/></joint>\n"
      "<joint name='c' type='revolute'><parent link='body'/><child link='shin'/><limit effort='much'/></joint>\n"
      "<joint name='d' type='fixed'><parent link='body'/></joint>\n");
  EXPECT_EQ(parse_urdf(wrong, "robot.urdf").joints.size(), 4u) << "a ring's file asks it for limits alone";
  try {
    parse_urdf(wrong, "robot.urdf", /*whole=*/true);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(),
                 "robot.urdf:3: joint 'a' has no parent; allowed: <parent link=\"LINK\"/>\n"
                 "robot.urdf:4: joint 'b' has the child 'foot'; there is no such <link>\n"
                 "robot.urdf:4: joint 'b' has the limits 1 to 0; allowed: lower less than upper\n"
                 "robot.urdf:5: joint 'c' has effort=\"much\"; allowed: a number such as -0.5\n"
                 "robot.urdf:6: joint 'd' has no child; allowed: <child link=\"LINK\"/>");
  }
}

TEST_F(Urdf, OfAWholeRobotIsATreeOfLinks) {
  const auto refused = [](const std::string& parts) -> std::string {
    try {
      parse_urdf(robot("<link name='a'/><link name='b'/><link name='c'/>\n" + parts), "robot.urdf", /*whole=*/true);
      return {};
    } catch (const ConfigError& error) {
      return error.what();
    }
  };
  const auto joint = [](const char* name, const char* parent, const char* child) {
    return std::string("<joint name='") + name + "' type='fixed'><parent link='" + parent + "'/><child link='" + child +
           "'/></joint>\n";
  };
  EXPECT_EQ(refused(joint("1", "b", "a") + joint("2", "b", "c")), "");
  EXPECT_THAT(refused(joint("1", "a", "b")),
              StartsWith("robot.urdf:1: no joint leads to the links a, c; allowed: one such link"));
  EXPECT_THAT(refused(joint("1", "a", "b") + joint("2", "b", "c") + joint("3", "c", "a")),
              StartsWith("robot.urdf:3: link 'a' hangs in a loop of joints"));
  EXPECT_THAT(refused(joint("1", "b", "c") + joint("2", "c", "b")), HasSubstr("link 'b' hangs in a loop"));
  EXPECT_THAT(refused(joint("1", "b", "b") + joint("2", "a", "c")), HasSubstr(":3: link 'b' hangs in a loop"));
  EXPECT_THAT(refused("<link name='a'/>" + joint("1", "a", "b") + joint("2", "a", "c")),
              StartsWith("robot.urdf:3: link 'a' is there twice"));
}

TEST_F(Urdf, MayHaveCommentsBeforeItsXmlDeclarationAsOldXacroWrites) {
  const std::string text = "<!-- written by xacro -->\n<?xml version=\"1.0\" ?>\n" + knee("revolute", "");
  EXPECT_EQ(parse_urdf(text, "robot.urdf").joints.at("knee").line, 4);
}

TEST_F(Urdf, HasALimitThatIsWrong) {
  EXPECT_THAT(refusal(knee("revolute", "<limit lower='-1' upper='1' velocity='fast' effort='9'/>")),
              HasSubstr("entry 'nodes[0].joints[0]': joint 'knee' has velocity=\"fast\" in " + folder_ +
                        "/robot.urdf:2; allowed: a number, there or as 'velocity' here"));
  EXPECT_THAT(refusal(knee("revolute", "<limit lower='${-pi}' upper='1' velocity='1' effort='9'/>")),
              HasSubstr("has lower=\"${-pi}\" in "));
  EXPECT_THAT(refusal(knee("revolute", "<limit lower='a' upper='b' velocity='c' effort='d'/>")),
              AllOf(HasSubstr("lower=\"a\""), HasSubstr("upper=\"b\""), HasSubstr("velocity=\"c\""),
                    HasSubstr("effort=\"d\"")));
  EXPECT_THAT(refusal(knee("revolute", "<limit lower='1' velocity='1' effort='9'/>")),
              HasSubstr("joint 'knee' has the limits 1 to 0 rad"));
}

}  // namespace
}  // namespace limb_ring::config
