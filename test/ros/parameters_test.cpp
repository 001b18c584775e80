#include "ros_bridge/parameters.h"

#include <gmock/gmock.h>

#include <cmath>

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

TEST(BridgeNode, IsTheOnlyOneWithAnAttachedCpuIfNoneIsNamed) { EXPECT_EQ(bridge_node(small_robot(), "").name, "body"); }

TEST(BridgeNode, MayBeNamedByNameOrId) {
  const auto ring = config::load_ring(LIMB_RING_CONFIG_DIR "/two_bridges.yaml");
  EXPECT_EQ(bridge_node(ring, "head").id, 2);
  EXPECT_EQ(bridge_node(ring, "2").name, "head");
}

TEST(BridgeNode, IsTheFirstOfSeveralIfNoneIsNamed) {
  const auto ring = config::load_ring(LIMB_RING_CONFIG_DIR "/two_bridges.yaml");
  EXPECT_EQ(bridge_node(ring, "").name, "body");
}

TEST(BridgeNode, IsRefusedWithTheChoiceIfItIsUnknownOrHasACpuOfItsOwn) {
  EXPECT_THAT(refusal(small_robot(), "tail"), HasSubstr("no node 'tail'"));
  EXPECT_THAT(refusal(small_robot(), "knee"), HasSubstr("has a CPU of its own"));
  EXPECT_THAT(refusal(small_robot(), "knee"), HasSubstr("nodes for a bridge: body"));
}

TEST(BridgeNode, IsRefusedIfItHasJointsOrSensorsOfWhichNothingWouldEverCome) {
  auto ring = small_robot();
  ring.nodes[0].sensors = {ring.nodes[2].sensors[0]};
  EXPECT_THAT(refusal(ring, ""),
              HasSubstr("node 'body' of small.yaml has sensor 'hip_imu', and ring_bridge is its CPU"));
  EXPECT_THAT(refusal(ring, "body"), HasSubstr("give it to a node with firmware"));
  ring.nodes[0].joints = {ring.nodes[1].joints[0]};
  EXPECT_THAT(refusal(ring, ""), HasSubstr("has joint 'knee_pitch'"));
}

TEST(Parameter, IsTheGivenValueElseTheDefault) {
  using XmlRpc::XmlRpcValue;
  EXPECT_EQ(text_parameter("node", XmlRpcValue("head")), "head");
  EXPECT_EQ(text_parameter("node", XmlRpcValue(12)), "12");
  EXPECT_EQ(text_parameter("node", {}), "");
  EXPECT_EQ(number_parameter("rate", XmlRpcValue(20), 50), 20);
  EXPECT_EQ(number_parameter("rate", XmlRpcValue(0.5), 50), 0.5);
  EXPECT_EQ(number_parameter("rate", {}, 50), 50);
  EXPECT_TRUE(flag_parameter("promises", XmlRpcValue(true), false));
  EXPECT_TRUE(flag_parameter("promises", {}, true));
}

TEST(Rate, IsAsConfiguredOrOneThatTheBridgeCanKeep) {
  using XmlRpc::XmlRpcValue;
  EXPECT_EQ(rate_parameter({}, 50), 50);
  EXPECT_EQ(rate_parameter(XmlRpcValue(0.0), 50), 50);
  EXPECT_EQ(rate_parameter(XmlRpcValue(0.01), 50), 0.01);
  EXPECT_EQ(rate_parameter(XmlRpcValue(1000), 50), 1000);
  for (const double wrong : {1e-12, 0.009, -1.0, 1001.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(rate_parameter(XmlRpcValue(wrong), 50), std::invalid_argument) << wrong;
}

/// What getParam() would take for not given, or round.
TEST(Parameter, OfAnotherTypeIsRefusedByName) {
  using XmlRpc::XmlRpcValue;
  const auto refused = [](const auto& read) -> std::string {
    try {
      read();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "not refused";
  };
  EXPECT_THAT(refused([] { text_parameter("config", XmlRpcValue(5.5)); }),
              HasSubstr("~config must be a text, and is '5.5'"));
  EXPECT_THAT(refused([] { text_parameter("node", XmlRpcValue(true)); }),
              HasSubstr("~node must be a text, and is 'true'"));
  EXPECT_THAT(refused([] { number_parameter("rate", XmlRpcValue("fast"), 0); }),
              HasSubstr("~rate must be a number, and is 'fast'"));
  XmlRpcValue list, map;
  list[0] = 1;
  list[1] = false;
  map["at"] = list;
  map["kinds"] = "data";
  EXPECT_THAT(refused([&] { text_parameter("clock", map); }), HasSubstr("is '{at: [1, false], kinds: data}'"));
  EXPECT_THAT(refused([] { flag_parameter("promises", XmlRpcValue("yes"), false); }),
              HasSubstr("~promises must be true or false, and is 'yes'"));
}

TEST(Parameter, ThatIsNeverReadIsFound) {
  EXPECT_TRUE(unknown_parameters(XmlRpc::XmlRpcValue()).empty());
  XmlRpc::XmlRpcValue own;
  own["config"] = "ring.yaml";
  own["rate"] = 50.0;
  own["noed"] = "head";
  EXPECT_EQ(unknown_parameters(own), std::vector<std::string>{"noed"});
}

TEST(BridgeNode, IsTheFirstNodeIfNoneHasAnAttachedCpu) {
  const auto ring = config::load_ring(LIMB_RING_CONFIG_DIR "/plain4.yaml");
  EXPECT_EQ(bridge_node(ring, "").name, "node0");
  EXPECT_THAT(refusal(ring, "node1"), HasSubstr("give one of them 'cpu: attached'"));
}

}  // namespace
}  // namespace limb_ring::bridge
