#include "ros_bridge/bridge.h"

#include <gtest/gtest.h>

#include "ros/small_robot.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using Action = Interrupt::Action;

class InterruptLogTest : public ::testing::Test {
 protected:
  std::string take(Action action, std::uint8_t source, std::uint8_t factor) {
    return log.take({action, source, factor}, now).value_or("");
  }

  const config::RingConfig ring = small_robot();
  InterruptLog log{ring};
  std::chrono::steady_clock::time_point now{1h};
};

TEST_F(InterruptLogTest, SaysWhichPinWhoAndWhatItDoes) {
  EXPECT_EQ(take(Action::notify, 7, 2), "INT2 from node knee: notify");
  EXPECT_EQ(take(Action::stop, 99, 1), "INT1 from node 99: stop") << "one that the ring's file does not have";
}

TEST_F(InterruptLogTest, HasALineASecondAndCountsTheOthers) {
  take(Action::notify, 7, 2);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(take(Action::notify, 7, 2), "");
  now += 1s;
  EXPECT_EQ(take(Action::notify, 3, 4), "INT4 from node hip: notify; 1000 more since the last such line");
  now += 1s;
  EXPECT_EQ(take(Action::notify, 3, 4), "INT4 from node hip: notify");
}

TEST_F(InterruptLogTest, HidesNoStopBehindNotifies) {
  take(Action::notify, 7, 2);
  EXPECT_EQ(take(Action::stop, 7, 1), "INT1 from node knee: stop");
}

}  // namespace
}  // namespace limb_ring::bridge
