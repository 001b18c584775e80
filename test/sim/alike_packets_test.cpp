// More packets under way than there are sequence numbers, alike to the last byte.
#include <gtest/gtest.h>

#include "sim/invariants.h"
#include "sim/virtual_line_faults.h"
#include "support/node_literal.h"

namespace limb_ring::sim {
namespace {

TEST(AlikePackets, AreNotTakenForOneAnotherInAnOpenChainWithALongLine) {
  VirtualRingOptions options;
  options.nodes = 5;
  VirtualRing ring(options);
  Invariants invariants(ring);
  VirtualLineFaults faults(ring, 1);
  faults.tap_all();
  ASSERT_TRUE(ring.join());
  faults.begin(1_id, core::Line::first, fault::Fault{});
  fault::Fault long_line;
  long_line.name = fault::Name::delay;
  long_line.delay = std::chrono::milliseconds(3);
  faults.begin(3_id, core::Line::first, long_line);
  ring.run_for(std::chrono::seconds(1));
  for (unsigned i = 0; i < 60; ++i) ring.send(2_id, wire::kBroadcast, {1});
  ring.run_for(std::chrono::seconds(1));
  EXPECT_EQ(ring.log(4_id).packets.size(), 60u);
  EXPECT_FALSE(invariants.violation()) << invariants.violation()->what();
}

}  // namespace
}  // namespace limb_ring::sim
