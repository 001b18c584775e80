#include <gmock/gmock.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "config/load_ring.h"

namespace limb_ring::bridge {
namespace {

constexpr double kDensity = 2000;  // kg/m3, as the file's head says

class HumanoidDescription : public ::testing::Test {
 protected:
  static urdf::ModelInterfaceSharedPtr read() {
    std::ostringstream text;
    text << std::ifstream(LIMB_RING_URDF_DIR "/humanoid16.urdf").rdbuf();
    return urdf::parseURDF(text.str());
  }
  void SetUp() override { ASSERT_TRUE(model); }

  const config::RingConfig ring = config::load_ring(LIMB_RING_CONFIG_DIR "/humanoid16.yaml");
  const urdf::ModelInterfaceSharedPtr model = read();
};

struct Solid {
  double mass, xx, yy, zz;  // kg, kg m2 about its centre
};

Solid solid(const urdf::Geometry& shape) {
  if (shape.type == urdf::Geometry::SPHERE) {
    const double r = static_cast<const urdf::Sphere&>(shape).radius;
    const double mass = kDensity * 4 / 3 * M_PI * r * r * r;
    return {mass, 0.4 * mass * r * r, 0.4 * mass * r * r, 0.4 * mass * r * r};
  }
  if (shape.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(shape);
    const double r = cylinder.radius, l = cylinder.length, mass = kDensity * M_PI * r * r * l;
    const double across = mass * (3 * r * r + l * l) / 12;
    return {mass, across, across, mass * r * r / 2};
  }
  const auto& size = static_cast<const urdf::Box&>(shape).dim;
  const double x = size.x, y = size.y, z = size.z, mass = kDensity * x * y * z;
  return {mass, mass * (y * y + z * z) / 12, mass * (x * x + z * z) / 12, mass * (x * x + y * y) / 12};
}

TEST_F(HumanoidDescription, HasTheJointsOfTheConfigurationWithTheirLimits) {
  std::ptrdiff_t joints = 0;
  for (const auto& node : ring.nodes)
    for (const auto& configured : node.joints) {
      const auto joint = model->getJoint(configured.name);
      ASSERT_TRUE(joint) << configured.name;
      EXPECT_EQ(joint->limits->lower, configured.lower) << configured.name;
      EXPECT_EQ(joint->limits->upper, configured.upper) << configured.name;
      EXPECT_EQ(joint->limits->velocity, configured.velocity) << configured.name;
      EXPECT_EQ(joint->limits->effort, configured.effort) << configured.name;
      ++joints;
    }
  const auto moves = [](const auto& joint) { return joint.second->type != urdf::Joint::FIXED; };
  EXPECT_EQ(std::count_if(model->joints_.begin(), model->joints_.end(), moves), joints);
}

TEST_F(HumanoidDescription, HasALinkForTheFrameOfEverySensor) {
  for (const auto& node : ring.nodes)
    for (const auto& sensor : node.sensors) EXPECT_TRUE(model->getLink(sensor.name)) << sensor.name;
}

TEST_F(HumanoidDescription, HasTheFramesOfAHumanoid) {
  EXPECT_EQ(model->getRoot()->name, "base_link");
  EXPECT_FALSE(model->getRoot()->inertial) << "KDL has no inertia for a root";
  for (const std::string side : {"l", "r"}) {
    ASSERT_TRUE(model->getLink(side + "_sole"));
    const auto foot = model->getLink(side + "_ankle_roll_link");
    const auto& shape = static_cast<const urdf::Box&>(*foot->visual->geometry);
    const auto& sole = model->getLink(side + "_sole")->parent_joint->parent_to_joint_origin_transform.position;
    EXPECT_NEAR(sole.z, foot->visual->origin.position.z - shape.dim.z / 2, 1e-9) << "below the foot";
    EXPECT_EQ(sole.x, 0) << "below the ankle";
    EXPECT_EQ(sole.y, 0);
  }
}

TEST_F(HumanoidDescription, HasTheInertialsOfItsShapes) {
  constexpr double kDigits = 1e-3;  // the file has four
  double total = 0;
  for (const auto& [name, link] : model->links_) {
    ASSERT_EQ(link->inertial != nullptr, link->visual != nullptr) << name;
    if (!link->inertial) continue;
    const auto& given = *link->inertial;
    const Solid right = solid(*link->visual->geometry);
    EXPECT_NEAR(given.mass, right.mass, kDigits * right.mass) << name;
    EXPECT_NEAR(given.ixx, right.xx, kDigits * right.xx) << name;
    EXPECT_NEAR(given.iyy, right.yy, kDigits * right.yy) << name;
    EXPECT_NEAR(given.izz, right.zz, kDigits * right.zz) << name;
    EXPECT_TRUE(given.ixy == 0 && given.ixz == 0 && given.iyz == 0) << name;
    const auto &centre = given.origin.position, &shape = link->visual->origin.position;
    EXPECT_TRUE(centre.x == shape.x && centre.y == shape.y && centre.z == shape.z) << name;
    total += given.mass;
  }
  EXPECT_NEAR(total, 26, 0.5);
}

TEST_F(HumanoidDescription, HasTheSameShapesForCollisionAsForDisplay) {
  for (const auto& [name, link] : model->links_) {
    ASSERT_EQ(link->collision != nullptr, link->visual != nullptr) << name;
    if (!link->collision) continue;
    EXPECT_EQ(solid(*link->collision->geometry).mass, solid(*link->visual->geometry).mass) << name;
  }
}

}  // namespace
}  // namespace limb_ring::bridge
