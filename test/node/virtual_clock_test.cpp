#include "node/steering.h"

#include <gtest/gtest.h>

#include <memory>

namespace limb_ring::virtual_host {
namespace {

using namespace std::chrono_literals;
using NodeTime = VirtualClock::Time;

struct Clock : testing::Test {
  std::unique_ptr<event_loop::Timer> timer() {
    return clock.timer([this] { calls.push_back(clock.now()); });
  }

  sim::VirtualRing ring{sim::VirtualRingOptions{}};
  VirtualClock clock{ring};
  std::vector<NodeTime> calls;
};

TEST_F(Clock, ATimerRunsOutAtItsInstantOfTheRingsTime) {
  const auto one = timer();
  one->expires_at(NodeTime(3ms));
  ring.run_until(core::Time{} + 3ms - 1ns);
  EXPECT_TRUE(calls.empty());
  ring.run_until(core::Time{} + 1s);
  EXPECT_EQ(calls, std::vector<NodeTime>{NodeTime(3ms)});
}

TEST_F(Clock, ATimerThatIsSetAgainOrCancelledOrGoneDoesNotCallForItsOldInstant) {
  const auto later = timer(), cancelled = timer();
  auto gone = timer();
  for (auto* each : {later.get(), cancelled.get(), gone.get()}) each->expires_at(NodeTime(3ms));
  later->expires_at(NodeTime(5ms));
  cancelled->cancel();
  gone.reset();
  ring.run_until(core::Time{} + 1s);
  EXPECT_EQ(calls, std::vector<NodeTime>{NodeTime(5ms)});
}

TEST_F(Clock, WhatRunsOutWhileANodeStandsStillIsCalledWhenItGoesOn) {
  const auto first = timer(), second = timer(), cancelled = timer();
  first->expires_at(NodeTime(3ms));
  second->expires_at(NodeTime(9ms));
  cancelled->expires_at(NodeTime(3ms));
  clock.freeze();
  ring.run_until(core::Time{} + 5ms);
  EXPECT_TRUE(calls.empty());
  cancelled->cancel();
  clock.thaw();
  EXPECT_EQ(calls, std::vector<NodeTime>{NodeTime(5ms)});
  ring.run_until(core::Time{} + 1s);
  EXPECT_EQ(calls, (std::vector<NodeTime>{NodeTime(5ms), NodeTime(9ms)}));
}

TEST_F(Clock, WhatIsCalledWhenANodeGoesOnMayEndItAndThenNothingElseIs) {
  auto ending = std::make_unique<VirtualClock>(ring);
  ending->call_at(core::Time{} + 3ms, [&] {
    calls.push_back(NodeTime(3ms));
    ending.reset();
  });
  ending->call_at(core::Time{} + 4ms, [this] { calls.push_back(NodeTime(4ms)); });
  ending->freeze();
  ring.run_until(core::Time{} + 5ms);
  ending->thaw();
  EXPECT_EQ(calls, std::vector<NodeTime>{NodeTime(3ms)});
}

TEST_F(Clock, NothingIsCalledOnceItIsGone) {
  auto gone = std::make_unique<VirtualClock>(ring);
  gone->call_at(core::Time{} + 3ms, [this] { calls.push_back(NodeTime{}); });
  gone.reset();
  ring.run_until(core::Time{} + 1s);
  EXPECT_TRUE(calls.empty());
}

TEST_F(Clock, ATimerMayBeDestroyedByItsOwnCall) {
  std::unique_ptr<event_loop::Timer> own;
  own = clock.timer([&] { own.reset(); });
  own->expires_at(NodeTime(1ms));
  ring.run_until(core::Time{} + 1s);
  EXPECT_EQ(own, nullptr);
}

TEST_F(Clock, AnInstantOfTheCoreIsRoundedUpSoThatATimerNeverComesBeforeIt) {
  EXPECT_EQ(VirtualClock::at(core::Time{} + core::Duration(1)), NodeTime(1ns));
  EXPECT_EQ(VirtualClock::at(core::Time{} + 7ns), NodeTime(7ns));
  EXPECT_EQ(VirtualClock::at(core::kNever), NodeTime::max());
}

}  // namespace
}  // namespace limb_ring::virtual_host
