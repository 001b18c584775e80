#include "bench/suite.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace limb_ring::bench {
namespace {

Measurement of_p50(double p50) {
  Measurement measured;
  measured.round_trip_us.p50 = p50;
  return measured;
}

TEST(Cases, EachIsARowOfAllItsRoundsBesideTheReferenceOfEach) {
  Cases cases;
  cases.add("shm", Sending::one, of_p50(20), 10);
  cases.add("shm", Sending::one, of_p50(90), 30);
  cases.add("shm", Sending::one, of_p50(40), 10);
  cases.add("shm", Sending::all, of_p50(50), 10);
  const auto rows = cases.rows(Pinning::free);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].what, "shm");
  EXPECT_EQ(rows[0].pinning, Pinning::free);
  EXPECT_EQ(rows[0].sending, Sending::one);
  EXPECT_EQ(rows[0].measured.round_trip_us.p50, 40);
  EXPECT_EQ(rows[0].reference_ratio, 3) << "the median of ratios, not the ratio of medians";
  EXPECT_EQ(rows[1].sending, Sending::all);
}

TEST(Cases, WhatHasSomethingInAdditionIsComparedWithTheSameRingWithout) {
  Cases cases;
  cases.add("watched", Sending::one, of_p50(30), 10);
  cases.add_without("watched", Sending::one, of_p50(20));
  cases.add("watched", Sending::one, of_p50(50), 10);
  cases.add_without("watched", Sending::one, of_p50(20));
  cases.add("unix", Sending::one, of_p50(20), 10);
  const auto rows = cases.rows(Pinning::free);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].addition_ratio, 0) << "unix is a ring with nothing in addition";
  EXPECT_EQ(rows[1].addition_ratio, 2);
}

TEST(Cases, ThereIsNothingToCompareWhereTheCaseWasNotMeasured) {
  Cases cases;
  EXPECT_THROW(cases.add_without("watched", Sending::one, of_p50(20)), std::out_of_range);
}

}  // namespace
}  // namespace limb_ring::bench
