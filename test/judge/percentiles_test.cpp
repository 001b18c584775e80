#include "judge/percentiles.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace limb_ring::statistics {
namespace {

using namespace std::chrono_literals;

TEST(NearestRank, OfTwoOrFourIsTheLowerMiddleOne) {
  EXPECT_EQ(nearest_rank(2, 0.5), 0u);
  EXPECT_EQ(nearest_rank(4, 0.5), 1u);
  EXPECT_EQ(nearest_rank(5, 0.5), 2u);
}

TEST(NearestRank, IsAlwaysOneOfThem) {
  EXPECT_EQ(nearest_rank(1, 0), 0u);
  EXPECT_EQ(nearest_rank(1, 1), 0u);
  EXPECT_EQ(nearest_rank(100, 0), 0u);
  EXPECT_EQ(nearest_rank(100, 0.99), 98u);
  EXPECT_EQ(nearest_rank(100, 1), 99u);
}

TEST(Percentiles, AreMicrosecondsInAnyOrderOfSamples) {
  std::vector<core::Duration> samples{4us, 1us, 1500ns, 3us};
  const Percentiles p = percentiles(samples);
  EXPECT_EQ(p.min, 1);
  EXPECT_EQ(p.p50, 1.5);
  EXPECT_EQ(p.p99, 4);
  EXPECT_EQ(p.max, 4);
  EXPECT_EQ(p.samples, 4u);
}

TEST(Percentiles, OfNothingAreNull) {
  std::vector<core::Duration> none;
  const nlohmann::json json = to_json(percentiles(none));
  EXPECT_TRUE(json["p50"].is_null());
  EXPECT_EQ(json["samples"], 0);
}

}  // namespace
}  // namespace limb_ring::statistics
