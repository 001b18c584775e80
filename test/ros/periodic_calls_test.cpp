#include "ros_bridge/ring_port.h"

#include <gtest/gtest.h>

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;

PeriodicCalls::Time at(std::chrono::milliseconds time) { return PeriodicCalls::Time(time); }

TEST(PeriodicCalls, WithoutAPhaseItsPeriodsBeginWhenItIsAdded) {
  PeriodicCalls calls;
  int called = 0;
  calls.add(
      10ms, {}, [&] { ++called; }, at(3ms));
  EXPECT_EQ(calls.next_due(), at(13ms));
  calls.run(at(12ms));
  EXPECT_EQ(called, 0);
  calls.run(at(13ms));
  EXPECT_EQ(called, 1);
  EXPECT_EQ(calls.next_due(), at(23ms));
}

TEST(PeriodicCalls, APhaseCountsFromTheMultiplesOfThePeriod) {
  PeriodicCalls calls;
  calls.add(
      10ms, 4ms, [] {}, at(3ms));
  EXPECT_EQ(calls.next_due(), at(4ms));
  calls.restart(at(4ms));
  EXPECT_EQ(calls.next_due(), at(14ms)) << "a deadline that is reached counts as over";
  calls.restart(at(57ms));
  EXPECT_EQ(calls.next_due(), at(64ms));
}

TEST(PeriodicCalls, WhatALateOneHasMissedIsLeftOut) {
  PeriodicCalls calls;
  int called = 0;
  calls.add(
      10ms, {}, [&] { ++called; }, at(0ms));
  calls.run(at(35ms));
  calls.run(at(35ms));
  EXPECT_EQ(called, 1);
  EXPECT_EQ(calls.next_due(), at(40ms)) << "deadlines stay where they would have been";
}

TEST(PeriodicCalls, OfSeveralTheFirstDeadlineIsNextAndOnlyWhatIsDueIsCalled) {
  PeriodicCalls calls;
  int often = 0, seldom = 0;
  calls.add(
      30ms, {}, [&] { ++seldom; }, at(0ms));
  calls.add(
      10ms, {}, [&] { ++often; }, at(0ms));
  EXPECT_EQ(calls.next_due(), at(10ms));
  for (auto time = 0ms; time <= 30ms; time += 1ms) calls.run(at(time));
  EXPECT_EQ(often, 3);
  EXPECT_EQ(seldom, 1);
}

TEST(PeriodicCalls, NothingIsDueIfThereIsNoCall) { EXPECT_EQ(PeriodicCalls().next_due(), PeriodicCalls::Time::max()); }

TEST(PeriodicCalls, OnAClockThatIsBehindTheyAreCountedAnew) {
  PeriodicCalls calls;
  calls.add(
      10ms, {}, [] {}, at(5000ms));
  calls.restart(at(2ms));
  EXPECT_EQ(calls.next_due(), at(12ms));
}

}  // namespace
}  // namespace limb_ring::bridge
