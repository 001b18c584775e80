#include "ros_bridge/services.h"

#include <gmock/gmock.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "limb_ring/host_port.h"
#include "ros/small_robot.h"
#include "support/thrown.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

std::vector<std::string> names_of(const std::vector<ask::Node>& nodes) {
  std::vector<std::string> names;
  for (const auto& node : nodes) names.push_back(node.name);
  return names;
}

TEST(ServiceRequest, ATimeoutOfZeroIsTheDefault) {
  EXPECT_EQ(timeout_of(ros::Duration(0)), 10s);
  EXPECT_EQ(timeout_of(ros::Duration(0), 3s), 3s);
}

TEST(ServiceRequest, ATimeoutIsOneMillisecondToOneMinute) {
  EXPECT_EQ(timeout_of(ros::Duration(0.001)), 1ms);
  EXPECT_EQ(timeout_of(ros::Duration(60.0)), 60s);
  for (const double wrong : {-1.0, 0.0009, 60.1})
    EXPECT_THAT(test::thrown<std::invalid_argument>([wrong] { timeout_of(ros::Duration(wrong), 3s); }),
                HasSubstr("it must be 0 (for 3 s), or 1 ms to 60 s"));
}

TEST(ServiceRequest, SecondsThatRosserviceTookForNanosecondsAreRefusedWithTheWayToWriteThem) {
  EXPECT_THAT(test::thrown<std::invalid_argument>([] { timeout_of(ros::Duration(0, 2)); }),
              HasSubstr("timeout of 2ns; it must be 0 (for 10 s), or 1 ms to 60 s: to rosservice 2 s are {secs: 2}"));
}

TEST(ServiceRequest, ANodeGoesByItsNameOrItsId) {
  const auto ring = small_robot();
  EXPECT_EQ(one_node(ring, "knee"), 7);
  EXPECT_EQ(one_node(ring, "7"), 7);
  EXPECT_EQ(destination_of(ring, "hip"), 3);
  EXPECT_EQ(destination_of(ring, "all"), kBroadcast);
}

TEST(ServiceRequest, AnUnknownNodeIsRefusedWithThoseThereAre) {
  const auto ring = small_robot();
  const auto said = test::thrown<std::invalid_argument>([&ring] { one_node(ring, "elbow"); });
  EXPECT_EQ(said, "no node 'elbow' in ring small; there are: body (0), knee (7), hip (3)");
  EXPECT_THROW(one_node(ring, "all"), std::invalid_argument) << "that is not one";
  EXPECT_THROW(nodes_to_ask(ring, "elbow"), std::invalid_argument);
}

TEST(ServiceRequest, AllAreAskedIfNoneIsNamed) {
  const auto ring = small_robot();
  for (const char* all : {"", "all"})
    EXPECT_THAT(names_of(nodes_to_ask(ring, all)), ::testing::ElementsAre("body", "knee", "hip"));
  for (const char* one : {"hip", "3"}) EXPECT_THAT(names_of(nodes_to_ask(ring, one)), ::testing::ElementsAre("hip"));
}

}  // namespace
}  // namespace limb_ring::bridge
