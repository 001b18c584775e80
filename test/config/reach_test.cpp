// Who reaches whom in an open chain.
#include "config/watchdog.h"
#include "support/node_literal.h"

#include <gtest/gtest.h>

namespace limb_ring::watchdog {
namespace {

using Broken = core::BrokenLine;
const std::vector<wire::NodeId> kOrder{10_id, 20_id, 30_id, 40_id};

void expect(const std::optional<Broken>& broken, wire::NodeId from, wire::NodeId to, bool sends, bool hears) {
  const Reach reach = reach_of(kOrder, broken, from, to);
  EXPECT_EQ(reach.sends, sends) << int(from) << " to " << int(to);
  EXPECT_EQ(reach.hears, hears) << int(to) << " by " << int(from);
}

TEST(Reach, OfAClosedRingIsEverybody) {
  expect(std::nullopt, 10_id, 40_id, true, true);
  expect(std::nullopt, 40_id, 10_id, true, true);
  expect(std::nullopt, 20_id, 20_id, true, true);
}

TEST(Reach, InAnOpenChainIsOneWay) {
  const Broken broken{20_id, 30_id};  // the chain is 30, 40, 10, 20
  expect(broken, 30_id, 20_id, true, false);
  expect(broken, 40_id, 10_id, true, false);
  expect(broken, 10_id, 40_id, false, true);
  expect(broken, 20_id, 30_id, false, true);
}

TEST(Reach, OfTheOwnPinNeedsAWholeRing) { expect(Broken{20_id, 30_id}, 10_id, 10_id, false, true); }

}  // namespace
}  // namespace limb_ring::watchdog
