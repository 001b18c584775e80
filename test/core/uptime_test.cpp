// A robot stays on: the core a century after its start.
#include "core/solo_node.h"
#include "support/node_literal.h"

namespace limb_ring::core {
namespace {

constexpr Duration kCentury = 100 * 365 * 24h;

TEST(Uptime, NeverIsLaterThanACentury) {
  EXPECT_GT(kNever, Time{} + kCentury);
  EXPECT_EQ(kNever - Time{}, Duration::max());
  EXPECT_GT(Time{} + kCentury, Time{});
}

TEST(Uptime, PicosecondsInSixtyFourBitsEndAtTheirRange) {
  EXPECT_EQ(picoseconds(5ns), 5000);
  EXPECT_EQ(picoseconds(Duration{-1}), 0);
  EXPECT_EQ(picoseconds(kCentury), INT64_MAX);
}

TEST(Uptime, WholeNanosecondsAreRoundedTowardsZeroAndLastForACentury) {
  EXPECT_EQ(whole_nanoseconds(Duration{1999}), 1ns);
  EXPECT_EQ(whole_nanoseconds(Duration{-1999}), -1ns);
  EXPECT_EQ(whole_nanoseconds(kCentury + Duration{1999}), kCentury + 1ns);
  EXPECT_EQ(whole_nanoseconds(-kCentury - Duration{1999}), -kCentury - 1ns);
}

TEST(Uptime, ARingDeliversRetriesAndRefusesAsOnItsFirstDay) {
  VirtualRing ring(quick(4));
  ASSERT_TRUE(ring.join());
  ring.run_for(kCentury);
  EXPECT_EQ(outcome_of(ring, 0_id, ring.send(0_id, 2_id, {1, 2, 3})).outcome, Outcome::delivered);
  EXPECT_EQ(outcome_of(ring, 1_id, ring.interrupt(1_id, 3_id, 2)).outcome, Outcome::delivered);
  ring.tap(2_id, lose(1, is_data));
  const SendEnded again = outcome_of(ring, 0_id, ring.send(0_id, 2_id, {4}));
  EXPECT_EQ(again.outcome, Outcome::delivered);
  EXPECT_EQ(again.tries, 2);
  ring.set_cpu_reads(2_id, false);
  SendEnded last;
  for (unsigned i = 0; i < 40; ++i) last = outcome_of(ring, 0_id, ring.send(0_id, 2_id, {5}));
  EXPECT_EQ(last.outcome, Outcome::refused);
}

TEST(Uptime, BeaconsKeepTheirPeriod) {
  SoloNode solo(Duration{0}, [](Settings& settings) { settings.beacon = 100ms; });
  solo.join();
  Time now = Time{} + kCentury;
  solo.node().handle_timeout(now);
  solo.node().run(now);
  const Time next = solo.node().next_deadline(now);
  EXPECT_GT(next, now);
  EXPECT_LE(next, now + 100ms);
}

}  // namespace
}  // namespace limb_ring::core
