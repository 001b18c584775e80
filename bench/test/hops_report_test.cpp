// The table of bench_sim_hops: what is said of rates that were measured.
#include "hops_report.h"

#include <gtest/gtest.h>

namespace {

using namespace limb_ring;
using hops::Series;

const Series kBare{"bare", {{{8e6, 4e6, 8e6}, {4e6, 4e6, 2e6}}}};

TEST(HopsReport, RatesAreTheBestOfTheRoundsInMillions) {
  const auto rows = hops::report({kBare});
  EXPECT_DOUBLE_EQ(rows[0]["m_hops_s_16"], 8);
  EXPECT_DOUBLE_EQ(rows[0]["m_hops_s_254"], 4);
}

TEST(HopsReport, TheFirstRowHasTheRelativeCostOne) { EXPECT_DOUBLE_EQ(hops::report({kBare})[0]["cost_16"], 1); }

TEST(HopsReport, CostIsTheMedianOfRatiosWithinARound) {
  // 8/2, 4/1, 8/4: 4, 4, 2. The bests alone would say 8/4 = 2.
  const auto rows = hops::report({kBare, {"core", {{{2e6, 1e6, 4e6}, {1e6, 1e6, 1e6}}}}});
  EXPECT_DOUBLE_EQ(rows[1]["cost_16"], 4);
  // 4/1, 4/1, 2/1
  EXPECT_DOUBLE_EQ(rows[1]["cost_254"], 4);
}

TEST(HopsReport, GrowthIsTheRatioOfTheLargeRingsCostToTheSmallOnesInTheSameRound) {
  // 8/4, 4/4, 8/2: 2, 1, 4
  EXPECT_DOUBLE_EQ(hops::report({kBare})[0]["growth"], 2);
}

TEST(HopsReport, TheMedianOfAnEvenNumberOfRoundsIsTheMiddle) {
  // 8/2, 8/4: 4, 2
  const Series bare{"bare", {{{8e6, 8e6}, {8e6, 8e6}}}}, core{"core", {{{2e6, 4e6}, {8e6, 8e6}}}};
  EXPECT_DOUBLE_EQ(hops::report({bare, core})[1]["cost_16"], 3);
}

TEST(HopsReport, WhatWasNotMeasuredIsNull) {
  const auto rows = hops::report({kBare, {"ns-3", {}}});
  for (const char* column : {"m_hops_s_16", "cost_16", "m_hops_s_254", "cost_254", "growth"})
    EXPECT_TRUE(rows[1][column].is_null()) << column;
}

}  // namespace
