#include "tools/firmware/simulated_limb.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace limb_ring::firmware {
namespace {

ServoTarget position(double value) {
  ServoTarget target;
  target.position = value;
  return target;
}

/// Steps on in virtual time and keeps the extremes that were reached.
struct Watched {
  explicit Watched(const ServoModel& model) : servo(model) {}

  void run(double seconds, double step = 0.01) {
    for (double t = 0; t < seconds; t += step) {
      servo.step(step);
      highest = std::max(highest, servo.position());
      lowest = std::min(lowest, servo.position());
      fastest = std::max(fastest, std::fabs(servo.velocity()));
      strongest = std::max(strongest, std::fabs(servo.effort()));
    }
  }

  Servo servo;
  double highest = -1e9, lowest = 1e9, fastest = 0, strongest = 0;
};

TEST(Servo, StartsAtItsInitialPositionAndStaysThere) {
  ServoModel model;
  model.initial = 0.7;
  Watched watched(model);
  watched.run(1);
  EXPECT_DOUBLE_EQ(watched.servo.position(), 0.7);
  EXPECT_DOUBLE_EQ(watched.servo.effort(), 0);
}

TEST(Servo, SettlesAtTheTarget) {
  Watched watched{ServoModel{}};
  watched.servo.drive(position(1.0));
  watched.run(1);
  EXPECT_NEAR(watched.servo.position(), 1.0, 1e-6);
  EXPECT_NEAR(watched.servo.velocity(), 0, 1e-5);
  EXPECT_LT(watched.highest, 1.05);
}

TEST(Servo, AnswersASmallStepAsASecondOrderSystem) {
  // Critically damped: x(t) = s (1 - (1 + w t) exp(-w t)); no limit is reached.
  ServoModel model;
  model.damping = 1.0;
  model.bandwidth = 4.0;
  Servo servo(model);
  servo.drive(position(0.01));
  const double w = 2 * 3.14159265358979 * 4.0;
  for (int ms = 1; ms <= 200; ++ms) {
    servo.step(0.001);
    const double wt = w * ms / 1000.0;
    EXPECT_NEAR(servo.position(), 0.01 * (1 - (1 + wt) * std::exp(-wt)), 0.0002) << ms << " ms";
  }
}

TEST(Servo, OvershootsOnlyIfItIsUnderdamped) {
  ServoModel model;
  model.damping = 0.2;
  Watched loose(model);
  loose.servo.drive(position(0.01));
  loose.run(2);
  EXPECT_GT(loose.highest, 0.014);  // exp(-pi z / sqrt(1 - z^2)) = 53 % over
  EXPECT_NEAR(loose.servo.position(), 0.01, 1e-5);
}

TEST(Servo, KeepsItsSpeedAndTorqueLimits) {
  ServoModel model;
  model.velocity = 2.0;
  model.effort = 5.0;
  Watched watched(model);
  watched.servo.drive(position(3.0));
  watched.run(3, 0.001);
  EXPECT_NEAR(watched.fastest, 2.0, 1e-9);
  EXPECT_NEAR(watched.strongest, 5.0, 1e-9);
  EXPECT_NEAR(watched.servo.position(), 3.0, 1e-4);
}

TEST(Servo, ClampsATargetBeyondItsPositionLimits) {
  ServoModel model;
  model.lower = -0.5;
  model.upper = 0.25;
  Watched watched(model);
  watched.servo.drive(position(9.0));
  watched.run(1);
  EXPECT_NEAR(watched.servo.position(), 0.25, 1e-6);
  watched.servo.drive(position(-9.0));
  watched.run(1);
  EXPECT_NEAR(watched.servo.position(), -0.5, 1e-6);
  EXPECT_LE(watched.highest, 0.25);
  EXPECT_GE(watched.lowest, -0.5);
}

TEST(Servo, StandsStillAtItsStop) {
  ServoModel model;
  model.upper = 0.1;
  Watched watched(model);
  ServoTarget target;
  target.velocity = 1.0;
  watched.servo.drive(target);
  watched.run(2);
  EXPECT_DOUBLE_EQ(watched.servo.position(), 0.1);
  EXPECT_DOUBLE_EQ(watched.servo.velocity(), 0);
}

TEST(Servo, FollowsAVelocity) {
  Watched watched{ServoModel{}};
  ServoTarget target;
  target.velocity = -0.5;
  watched.servo.drive(target);
  watched.run(1);
  EXPECT_NEAR(watched.servo.velocity(), -0.5, 1e-6);
  EXPECT_NEAR(watched.servo.position(), -0.5, 0.02);
}

TEST(Servo, FollowsAMovingPositionWithoutLagIfItsRateIsGiven) {
  Servo plain{ServoModel{}}, fed{ServoModel{}};
  for (int ms = 0; ms <= 1000; ++ms) {
    plain.drive(position(ms / 1000.0));
    ServoTarget target = position(ms / 1000.0);
    target.velocity = 1.0;
    fed.drive(target);
    if (ms < 1000) plain.step(0.001), fed.step(0.001);
  }
  EXPECT_NEAR(fed.position(), 1.0, 0.002);
  EXPECT_GT(1.0 - plain.position(), 0.03);  // 2 z / w
}

TEST(Servo, GivesTheTorqueAskedForAndReportsIt) {
  Servo servo{ServoModel{}};
  ServoTarget target;
  target.effort = 4.0;
  servo.drive(target);
  servo.step(0.3);
  EXPECT_DOUBLE_EQ(servo.effort(), 4.0);
  EXPECT_GT(servo.velocity(), 0.1);
  target.effort = 1000.0;
  servo.drive(target);
  servo.step(0.01);
  EXPECT_DOUBLE_EQ(servo.effort(), 50.0);
}

TEST(Servo, LetsItsVelocityDecayWhenReleased) {
  Servo servo{ServoModel{}};
  ServoTarget target;
  target.velocity = 3.0;
  servo.drive(target);
  servo.step(0.3);
  ASSERT_GT(servo.velocity(), 2.9);
  servo.release();
  servo.step(0.01);
  const double soon = servo.velocity();
  EXPECT_LT(soon, 2.9);
  EXPECT_GT(soon, 0);
  EXPECT_DOUBLE_EQ(servo.effort(), 0);
  servo.step(1);
  EXPECT_NEAR(servo.velocity(), 0, 1e-9);
}

TEST(Servo, IsStableForEveryModelAndStep) {
  for (double bandwidth : {0.1, 8.0, 100.0})
    for (double damping : {0.05, 0.9, 5.0})
      for (double step : {1e-6, 0.001, 0.01, 1.0, 1e6}) {
        ServoModel model;
        model.bandwidth = bandwidth;
        model.damping = damping;
        Servo servo(model);
        servo.drive(position(0.5));
        for (int i = 0; i < 100; ++i) servo.step(step);
        EXPECT_TRUE(std::isfinite(servo.position()));
        EXPECT_LE(std::fabs(servo.velocity()), 6.0);
        EXPECT_LE(std::fabs(servo.position()), 3.14);
      }
}

TEST(Servo, StandsStillForAStepOfNoTime) {
  Servo servo{ServoModel{}};
  servo.drive(position(1));
  servo.step(0);
  EXPECT_DOUBLE_EQ(servo.position(), 0);
}

}  // namespace
}  // namespace limb_ring::firmware
