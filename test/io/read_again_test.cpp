#include "io/input.h"

#include <gtest/gtest.h>

namespace limb_ring::link {
namespace {

/// How many turns pass until the next read that is only tried.
unsigned turns_until_tried(ReadAgain& again) {
  unsigned turns = 1;
  while (!again.wanted()) ++turns;
  return turns;
}

TEST(ReadAgain, IsTriedNowAndThen) {
  ReadAgain again;
  EXPECT_EQ(turns_until_tried(again), ReadAgain::kTryEvery);
  again.found(false);
  EXPECT_EQ(turns_until_tried(again), ReadAgain::kTryEvery);
}

TEST(ReadAgain, GoesOnForAsLongAsItFindsSomething) {
  ReadAgain again;
  turns_until_tried(again);
  for (int i = 0; i < 100; ++i) {
    again.found(true);
    ASSERT_TRUE(again.wanted());
  }
}

TEST(ReadAgain, EndsSoonIfItFindsNothing) {
  ReadAgain again;
  for (int i = 0; i < 100; ++i) again.found(true);
  int in_vain = 0;
  for (; again.wanted(); ++in_vain) again.found(false);
  EXPECT_LE(in_vain, 4);
}

}  // namespace
}  // namespace limb_ring::link
