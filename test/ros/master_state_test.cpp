#include "ros_bridge/ros_links.h"

#include <gtest/gtest.h>
#include <ros/init.h>

namespace limb_ring::bridge {
namespace {

/// The thread that asks would hang for ever, and with it all that it does.
TEST(MasterState, OfAMasterThatIsGoneIsNotWaitedFor) {
  ros::init(ros::M_string{{"__master", "http://127.0.0.1:1"}}, "master_state_test", ros::init_options::NoSigintHandler);
  EXPECT_FALSE(master_state());
}

TEST(MasterState, HasNoNodesForAnUnknownName) {
  const MasterState state{{{"/scan", {"/laser"}}}, {}, {}};
  EXPECT_EQ(MasterState::of(state.publishers, "/scan").size(), 1u);
  EXPECT_TRUE(MasterState::of(state.publishers, "/map").empty());
}

}  // namespace
}  // namespace limb_ring::bridge
