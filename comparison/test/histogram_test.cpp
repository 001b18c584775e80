#include "comparison/measurements.h"

#include "comparison/test/network_fixture.h"

namespace limb_ring::study {
namespace {

std::vector<Duration> limits(const std::vector<Bin>& bins) {
  std::vector<Duration> out{bins.front().from};
  for (const Bin& bin : bins) out.push_back(bin.to);
  return out;
}

std::vector<std::size_t> counts(const std::vector<Bin>& bins) {
  std::vector<std::size_t> out;
  for (const Bin& bin : bins) out.push_back(bin.count);
  return out;
}

TEST(Histogram, OfNothingIsEmpty) { EXPECT_TRUE(histogram({}, 10ns).empty()); }

// 11 and 20 lie in (10, 20], 21 in (20, 30], none in (30, 40], 41 in (40, 50].
TEST(Histogram, CountsEveryValueOnceAndLeavesNoGap) {
  const auto bins = histogram({41ns, 20ns, 11ns, 21ns}, 10ns);
  EXPECT_THAT(limits(bins), testing::ElementsAre(10ns, 20ns, 30ns, 40ns, 50ns));
  EXPECT_THAT(counts(bins), testing::ElementsAre(2u, 1u, 0u, 1u));
}

TEST(Histogram, ValueAtALimitIsInTheBinThatEndsThere) {
  const auto bins = histogram({10ns}, 10ns);
  EXPECT_THAT(limits(bins), testing::ElementsAre(0ns, 10ns));
}

}  // namespace
}  // namespace limb_ring::study
