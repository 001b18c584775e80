// If the kernel watches no more descriptors: what waits for room there goes on as soon as there is some.
#include <gtest/gtest.h>

#include <optional>

#include "io/link_rig.h"
#include "support/refused_watches.h"

namespace limb_ring::link {
namespace {

struct UnwatchedLine : OnEveryTransport {};

TEST_P(UnwatchedLine, IsTriedAgainAndEndsNobody) {
  LinkRig rig(2, GetParam());
  rig.start_input(0);
  rig.start_input(1);
  std::optional<test::RefusedWatches> full(std::in_place);
  rig.start_output(0);
  rig.start_output(1);
  EXPECT_TRUE(rig.until([&] { return rig.node(0).output->counters().attempts > 3; }));
  EXPECT_FALSE(rig.node(0).output->up());
  full.reset();
  EXPECT_TRUE(rig.until([&] { return rig.whole(); }));
}

LIMB_RING_ON_EVERY_TRANSPORT(UnwatchedLine);

}  // namespace
}  // namespace limb_ring::link
