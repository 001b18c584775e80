// A wire that is cut or held on purpose: who notices what, and that it is as new afterwards.
#include <gmock/gmock.h>

#include "io/link_rig.h"

namespace limb_ring::link {
namespace {

struct WireOfAnOutput : OnEveryTransport {
  LinkRig rig{3, GetParam()};
  Output& output() { return *rig.node(0).output; }
  InputCounters heard() { return rig.node(1).input->counters(); }
  void SetUp() override {
    rig.start_all();
    ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
  }
};
LIMB_RING_ON_EVERY_TRANSPORT(WireOfAnOutput);

TEST_P(WireOfAnOutput, CutLosesTheLineAndNobodyIsAskedForUntilItIsWhole) {
  const auto attempts = output().counters().attempts;
  output().set_wire(Wire::cut);
  EXPECT_FALSE(output().up());
  ASSERT_TRUE(rig.until([&] { return !rig.node(1).input->from(); }));
  EXPECT_EQ(heard().silences, udp() ? 1u : 0u) << "the end of a stream is seen at once, a missing datagram is not";
  rig.run_for(milliseconds(100));
  EXPECT_EQ(output().counters().attempts, attempts);
  EXPECT_TRUE(rig.linked(1, 2));
  output().set_wire(Wire::whole);
  EXPECT_TRUE(rig.until([&] { return rig.whole(); })) << "and not to the node beyond";
}

TEST_P(WireOfAnOutput, CutWhileABypassStillAsksForTheNearerNodeIsAsNewAfterwards) {
  rig.end(1);
  ASSERT_TRUE(rig.until([&] { return rig.linked(0, 2); }));
  output().set_wire(Wire::cut);
  rig.start(1);
  rig.run_for(milliseconds(100));
  EXPECT_FALSE(output().up());
  output().set_wire(Wire::whole);
  EXPECT_TRUE(rig.until([&] { return rig.whole(); }));
}

TEST_P(WireOfAnOutput, HeldIsSilentAndTheOtherEndGivesItUp) {
  output().set_wire(Wire::held);
  EXPECT_TRUE(output().up());
  ASSERT_TRUE(rig.until([&] { return !output().up(); }));
  EXPECT_EQ(heard().silences, 1u);
  rig.run_for(milliseconds(100));
  EXPECT_FALSE(rig.node(1).input->from());
  output().set_wire(Wire::whole);
  EXPECT_TRUE(rig.until([&] { return rig.whole(); }));
}

}  // namespace
}  // namespace limb_ring::link
