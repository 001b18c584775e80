// Who reaches whom in an open chain.
#include "watchdog/reach.h"

#include <gtest/gtest.h>

namespace limb_ring::watchdog {
namespace {

using Broken = core::BrokenLine;
const std::vector<wire::NodeId> kOrder{10, 20, 30, 40};

void expect(const std::optional<Broken>& broken, wire::NodeId from, wire::NodeId to, bool sends, bool hears) {
  const Reach reach = reach_of(kOrder, broken, from, to);
  EXPECT_EQ(reach.sends, sends) << int(from) << " to " << int(to);
  EXPECT_EQ(reach.hears, hears) << int(to) << " by " << int(from);
}

TEST(Reach, OfAClosedRingIsEverybody) {
  expect(std::nullopt, 10, 40, true, true);
  expect(std::nullopt, 40, 10, true, true);
  expect(std::nullopt, 20, 20, true, true);
}

TEST(Reach, InAnOpenChainIsOneWay) {
  const Broken broken{20, 30};  // the chain is 30, 40, 10, 20
  expect(broken, 30, 20, true, false);
  expect(broken, 40, 10, true, false);
  expect(broken, 10, 40, false, true);
  expect(broken, 20, 30, false, true);
}

TEST(Reach, OfTheOwnPinNeedsAWholeRing) { expect(Broken{20, 30}, 10, 10, false, true); }

}  // namespace
}  // namespace limb_ring::watchdog
