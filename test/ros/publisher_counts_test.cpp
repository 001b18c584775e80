#include "ros_bridge/publisher_counts.h"

#include <gtest/gtest.h>
#include <ros/init.h>

namespace limb_ring::bridge {
namespace {

/// The thread that asks would hang for ever, and with it all that it does.
TEST(PublisherCounts, OfAMasterThatIsGoneAreNotWaitedFor) {
  ros::init(ros::M_string{{"__master", "http://127.0.0.1:1"}}, "publisher_counts_test",
            ros::init_options::NoSigintHandler);
  EXPECT_TRUE(publisher_counts().empty());
}

}  // namespace
}  // namespace limb_ring::bridge
