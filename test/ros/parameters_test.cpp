#include "ros_bridge/parameters.h"

#include <gmock/gmock.h>

#include "config/load_ring.h"
#include "ros/small_robot.h"

namespace limb_ring::bridge {
namespace {

using ::testing::HasSubstr;

std::string refusal(const config::RingConfig& ring, const std::string& node) {
  try {
    bridge_node(ring, node);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "not refused";
}

TEST(BridgeNode, IsTheOnlyOneWithAnAttachedCpuWhereNoneIsNamed) {
  EXPECT_EQ(bridge_node(small_robot(), "").name, "body");
}

TEST(BridgeNode, MayBeNamedByNameOrId) {
  const auto ring = config::load_ring(LIMB_RING_CONFIG_DIR "/two_bridges.yaml");
  EXPECT_EQ(bridge_node(ring, "head").id, 2);
  EXPECT_EQ(bridge_node(ring, "2").name, "head");
}

TEST(BridgeNode, IsTheFirstOfSeveralWhereNoneIsNamed) {
  const auto ring = config::load_ring(LIMB_RING_CONFIG_DIR "/two_bridges.yaml");
  EXPECT_EQ(bridge_node(ring, "").name, "body");
}

TEST(BridgeNode, IsRefusedWithTheChoiceWhereItIsUnknownOrHasACpuOfItsOwn) {
  EXPECT_THAT(refusal(small_robot(), "tail"), HasSubstr("no node 'tail'"));
  EXPECT_THAT(refusal(small_robot(), "knee"), HasSubstr("has a CPU of its own"));
  EXPECT_THAT(refusal(small_robot(), "knee"), HasSubstr("nodes for a bridge: body"));
}

TEST(BridgeNode, IsTheFirstNodeWhereNoneHasAnAttachedCpu) {
  const auto ring = config::load_ring(LIMB_RING_CONFIG_DIR "/plain4.yaml");
  EXPECT_EQ(bridge_node(ring, "").name, "node0");
  EXPECT_THAT(refusal(ring, "node1"), HasSubstr("give one of them 'cpu: attached'"));
}

}  // namespace
}  // namespace limb_ring::bridge
