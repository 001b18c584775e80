#include "node/steering.h"

#include <gmock/gmock.h>

#include <limits>

namespace limb_ring::virtual_host {
namespace {

using namespace std::chrono_literals;
using core::Time;

class SteeringTest : public ::testing::Test {
 protected:
  static sim::VirtualRingOptions two_nodes() {
    sim::VirtualRingOptions options;
    options.order = {wire::NodeId{0}, wire::NodeId{1}};
    return options;
  }
  void reach(std::chrono::nanoseconds time) { ring.run_until(Time{} + time); }

  sim::VirtualRing ring{two_nodes()};
  Steering steering{ring};
  Pace pace{1, std::chrono::steady_clock::now()};
};

TEST_F(SteeringTest, LetsTimeGoOnUntilSomebodyAsks) {
  EXPECT_EQ(steering.limit(), core::kNever);
  EXPECT_FALSE(steering.holds());
}

TEST_F(SteeringTest, PausesAndRuns) {
  reach(1ms);
  steering.pause();
  EXPECT_TRUE(steering.holds());
  EXPECT_EQ(steering.limit(), Time{} + 1ms);
  EXPECT_TRUE(steering.state().paused);
  EXPECT_EQ(steering.state().now, 1ms);
  steering.run();
  EXPECT_FALSE(steering.holds());
  EXPECT_FALSE(steering.state().paused);
}

TEST_F(SteeringTest, AStepEndsWhereItIsToAndSaysSo) {
  unsigned ended = 0;
  steering.pause();
  steering.step(2ms, [&] { ++ended; });
  EXPECT_FALSE(steering.holds());
  EXPECT_EQ(steering.limit(), Time{} + 2ms);
  reach(2ms);
  EXPECT_EQ(ended, 0u);
  EXPECT_TRUE(steering.holds());
  EXPECT_TRUE(steering.holds());
  EXPECT_EQ(ended, 1u);
}

TEST_F(SteeringTest, AStepThatAnotherRequestOvertakesIsAnsweredToo) {
  unsigned ended = 0;
  steering.step(2ms, [&] { ++ended; });
  steering.step(3ms, [&] { ended += 10; });
  EXPECT_EQ(ended, 1u);
  steering.run();
  EXPECT_EQ(ended, 11u);
}

TEST_F(SteeringTest, FollowsAnOuterClockAndNoFurther) {
  EXPECT_FALSE(steering.allow(1ms, 0ns)) << "nobody has said that it follows one";
  Steering following(ring);
  following.follow();
  EXPECT_TRUE(following.holds()) << "the outer clock has not been heard";
  EXPECT_TRUE(following.allow(1ms, -5s));
  EXPECT_FALSE(following.holds());
  EXPECT_EQ(following.limit(), Time{} + 1ms);
  EXPECT_EQ(following.state().outer_zero, -5s);
  reach(1ms);
  EXPECT_TRUE(following.holds());
  EXPECT_FALSE(following.state().paused);
}

TEST_F(SteeringTest, RemembersWhoWasNotWaitedFor) {
  EXPECT_EQ(steering.left_behind(), "");
  steering.went_on_without("the controller /legs");
  EXPECT_EQ(steering.left_behind(), "the controller /legs");
}

TEST_F(SteeringTest, ChangesThePace) {
  steering.use(pace);
  steering.set_pace(0.5);
  EXPECT_EQ(steering.state().pace, 0.5);
  EXPECT_EQ(pace.factor(), 0.5);
  steering.set_pace(std::numeric_limits<double>::infinity());
  EXPECT_EQ(pace.allowed(std::chrono::steady_clock::now(), Time{}), core::kNever);
}

TEST_F(SteeringTest, APauseIsNotMadeUpFor) {
  steering.use(pace);
  steering.pause();
  const auto later = std::chrono::steady_clock::now();
  EXPECT_TRUE(steering.holds());
  EXPECT_GE(pace.when(Time{} + 1ms), later + 1ms);
  EXPECT_EQ(pace.lost(), 0ns);
}

}  // namespace
}  // namespace limb_ring::virtual_host
