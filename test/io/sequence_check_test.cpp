#include "io/datagram_input.h"

#include <gtest/gtest.h>

namespace limb_ring::link {
namespace {

TEST(SequenceCheck, TakesNumbersInOrder) {
  SequenceCheck check;
  for (std::uint32_t i = 1; i < 5; ++i) {
    const auto arrival = check.check(i);
    EXPECT_TRUE(arrival.fresh);
    EXPECT_EQ(arrival.lost, 0u);
  }
}

TEST(SequenceCheck, CountsWhatIsMissingAndDiscardsItWhenItComesLate) {
  SequenceCheck check;
  check.check(1);
  EXPECT_EQ(check.check(4).lost, 2u);
  EXPECT_FALSE(check.check(2).fresh);
  EXPECT_FALSE(check.check(4).fresh);
  EXPECT_TRUE(check.check(5).fresh);
}

TEST(SequenceCheck, MissesTheFirstOfASessionToo) {
  SequenceCheck check;
  EXPECT_EQ(check.check(3).lost, 2u);
}

TEST(SequenceCheck, GoesOnWhenTheNumbersWrap) {
  SequenceCheck check;
  check.check(0x7FFFFFFF);
  check.check(0xFFFFFFFE);
  EXPECT_TRUE(check.check(0xFFFFFFFF).fresh);
  const auto wrapped = check.check(0);
  EXPECT_TRUE(wrapped.fresh);
  EXPECT_EQ(wrapped.lost, 0u);
  EXPECT_FALSE(check.check(0xFFFFFFFF).fresh);
}

}  // namespace
}  // namespace limb_ring::link
