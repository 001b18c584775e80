#include <filesystem>
#include <fstream>
#include <iterator>

#include "config/option.h"
#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using namespace std::chrono_literals;

RingConfig shipped(const std::string& name) { return load_ring(std::string(SHIPPED_CONFIG) + '/' + name); }

std::size_t joints_of(const RingConfig& ring) {
  std::size_t joints = 0;
  for (const NodeConfig& node : ring.nodes) joints += node.joints.size();
  return joints;
}

TEST(ShippedFiles, AllLoadAndAreNamedAsTheirRing) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SHIPPED_CONFIG)) {
    // What ros_bridge's tools read is not a ring.
    if (entry.path().extension() != ".yaml" || entry.path().stem() == "analyzers") continue;
    ++files;
    EXPECT_NO_THROW(EXPECT_EQ(load_ring(entry.path().string()).ring, entry.path().stem().string()));
  }
  EXPECT_GE(files, 4u);
}

TEST(ShippedFiles, HumanoidHasItsNodesAndJoints) {
  const RingConfig ring = shipped("humanoid16.yaml");
  ASSERT_EQ(ring.nodes.size(), 16u);
  for (unsigned i = 0; i < 16; ++i) EXPECT_EQ(ring.nodes[i].id, i);
  EXPECT_EQ(ring.nodes[0].name, "body");
  EXPECT_EQ(ring.nodes[0].cpu.kind, CpuConfig::Kind::attached);
  EXPECT_EQ(joints_of(ring), 26u);
  for (const char* name : {"head", "left_shoulder", "right_elbow", "left_hip", "left_knee", "right_ankle"})
    EXPECT_NE(ring.find(name), nullptr) << name;
}

TEST(ShippedFiles, HumanoidsLimbsHaveFirmware) {
  const RingConfig ring = shipped("humanoid16.yaml");
  for (std::size_t i = 1; i < ring.nodes.size(); ++i) {
    EXPECT_EQ(ring.nodes[i].cpu.kind, CpuConfig::Kind::child) << ring.nodes[i].name;
    EXPECT_THAT(ring.nodes[i].cpu.command, ::testing::ElementsAre("limb_firmware"));
    EXPECT_GT(ring.nodes[i].cpu.alive_period, 0ms) << ring.nodes[i].name;
  }
  EXPECT_EQ(supervisor_of(ring).name, "body");
}

TEST(ShippedFiles, FirstRingOfTheTourHasACpuAtEveryNodeSoThatNoPacketIsRefused) {
  const RingConfig ring = shipped("leg8.yaml");
  for (const NodeConfig& node : ring.nodes) EXPECT_EQ(node.cpu.kind, CpuConfig::Kind::child) << node.name;
  for (const char* name : {"body", "head", "waist", "left_hip", "left_hip_yaw", "left_knee", "right_elbow"})
    EXPECT_NE(ring.find(name), nullptr) << name;
}

TEST(ShippedFiles, HumanoidsLeftAndRightAreAlike) {
  const RingConfig ring = shipped("humanoid16.yaml");
  for (const char* part : {"shoulder", "elbow", "hip", "hip_yaw", "knee", "ankle"}) {
    const NodeConfig& left = *ring.find(std::string("left_") + part);
    const NodeConfig& right = *ring.find(std::string("right_") + part);
    ASSERT_EQ(left.joints.size(), right.joints.size()) << part;
    for (std::size_t i = 0; i < left.joints.size(); ++i) {
      EXPECT_EQ(left.joints[i].name.substr(1), right.joints[i].name.substr(1));
      EXPECT_EQ(left.joints[i].lower, right.joints[i].lower);
      EXPECT_EQ(left.joints[i].upper, right.joints[i].upper);
      EXPECT_EQ(left.joints[i].initial, right.joints[i].initial);
    }
  }
}

TEST(ShippedFiles, TwoBridgesCarryCameraAndWrench) {
  const RingConfig ring = shipped("two_bridges.yaml");
  ASSERT_EQ(ring.bridge.topics.size(), 2u);
  EXPECT_EQ(ring.bridge.topics[0].from, ring.find("head")->id);
  EXPECT_EQ(ring.bridge.topics[0].to, ring.find("body")->id);
  EXPECT_EQ(ring.bridge.topics[0].priority, 3);
}

TEST(ShippedFiles, SlowLinesTimeoutsAreAboveTwoRoundTrips) {
  const RingConfig ring = shipped("slow_line.yaml");
  for (const NodeConfig& node : ring.nodes) {
    ASSERT_EQ(node.link.rate, 1000000u);
    const nanoseconds packet{524 * 8 * 1000000000ull / node.link.rate};
    EXPECT_GT(ring.timeouts.send, 2 * 4 * (packet + node.link.delay));
    EXPECT_GT(ring.timeouts.stall, packet + node.link.delay);
  }
}

TEST(ShippedFiles, OptionsAreThoseOfTheTable) {
  std::ifstream in(std::string(SHIPPED_CONFIG) + "/OPTIONS.md");
  const std::string committed{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(committed, options_markdown()) << "print it again: ringd --options > config/OPTIONS.md";
}

}  // namespace
}  // namespace limb_ring::config
