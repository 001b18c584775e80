#include "io/admission.h"

#include <gtest/gtest.h>

namespace limb_ring::link {
namespace {

constexpr std::uint64_t kRing = 7;

/// Node 3 of the ring 5 -> 1 -> 3 -> 9 -> 5.
Refusal judge(std::uint8_t from, std::optional<std::uint8_t> present, std::uint64_t ring = kRing) {
  LinkHeader connect;
  connect.ring = ring;
  connect.sender = from;
  return Admission({kRing, 3}, {5, 1, 3, 9}).judge(connect, present);
}

TEST(Admission, AcceptsAnyNodeOfTheRingIfThereIsNone) {
  for (const std::uint8_t from : {5, 1, 3, 9}) EXPECT_EQ(judge(from, {}), Refusal::none);
}

TEST(Admission, LetsANearerNodeTakeThePlaceOfAFartherOne) {
  EXPECT_EQ(judge(1, 5), Refusal::none);
  EXPECT_EQ(judge(5, 9), Refusal::none);
  EXPECT_EQ(judge(9, 3), Refusal::none);  // we ourselves are the farthest
}

TEST(Admission, LetsTheSameNodeComeAgainAfterARestart) { EXPECT_EQ(judge(5, 5), Refusal::none); }

TEST(Admission, TellsAFartherNodeThatItIsBusy) {
  EXPECT_EQ(judge(5, 1), Refusal::busy);
  EXPECT_EQ(judge(9, 5), Refusal::busy);
  EXPECT_EQ(judge(3, 9), Refusal::busy);
}

TEST(Admission, TurnsAwayAnotherVersionWhateverElseItSays) {
  LinkHeader connect;
  connect.version = 1;
  connect.ring = kRing;
  connect.sender = 5;
  EXPECT_EQ(Admission({kRing, 3}, {5, 1, 3, 9}).judge(connect, {}), Refusal::wrong_version);
}

TEST(Admission, TurnsAwayAnotherRingAndUnknownNodes) {
  EXPECT_EQ(judge(1, {}, kRing + 1), Refusal::wrong_ring);
  EXPECT_EQ(judge(4, {}), Refusal::not_in_ring);
}

}  // namespace
}  // namespace limb_ring::link
