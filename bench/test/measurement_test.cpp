#include "bench/measurement.h"

#include <gtest/gtest.h>

namespace limb_ring::bench {
namespace {

Measurement measured(double p50, double p99, double max, double rate, std::uint64_t packets = 1) {
  Measurement m;
  m.round_trip_us = {p50, p99, max};
  m.packets_per_second = rate;
  m.packets = packets;
  return m;
}

TEST(Median, IsTheMiddleOneOrBetweenTheTwoInTheMiddle) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_EQ(median({}), 0);
}

TEST(Measurement, OfSeveralSendersHasTheMedianOfMediansAndTheWorstOfTheRest) {
  const Measurement all = together({measured(10, 20, 30, 100), measured(12, 90, 95, 200), measured(11, 21, 400, 300)});
  EXPECT_EQ(all.round_trip_us.p50, 11);
  EXPECT_EQ(all.round_trip_us.p99, 90);
  EXPECT_EQ(all.round_trip_us.max, 400);
}

TEST(Measurement, OfSeveralSendersAddsUpTheirRatesAndCounts) {
  const Measurement all = together({measured(1, 1, 1, 100, 7), measured(1, 1, 1, 200, 8)});
  EXPECT_EQ(all.packets_per_second, 300);
  EXPECT_EQ(all.packets, 15u);
}

TEST(Measurement, OfSeveralRoundsHasTheirMediansAndTheWorstMaximum) {
  const Measurement all = of_rounds({measured(10, 20, 30, 100), measured(50, 90, 95, 10), measured(11, 21, 40, 90)});
  EXPECT_EQ(all.round_trip_us.p50, 11);
  EXPECT_EQ(all.round_trip_us.p99, 21);
  EXPECT_EQ(all.round_trip_us.max, 95);
  EXPECT_EQ(all.packets_per_second, 90);
  EXPECT_EQ(all.packets, 3u);
}

}  // namespace
}  // namespace limb_ring::bench
