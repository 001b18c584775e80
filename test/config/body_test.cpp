#include "config/ring_config.h"

#include <gmock/gmock.h>

namespace limb_ring::config {
namespace {

TEST(Body, IsTheFirstNodeWithAnAttachedCpuElseTheFirstNode) {
  RingConfig ring;
  ring.nodes.resize(3);
  for (std::uint8_t i = 0; i < 3; ++i) ring.nodes[i].id = static_cast<std::uint8_t>(7 + i);
  EXPECT_EQ(body_of(ring).id, 7);
  ring.nodes[1].cpu.kind = CpuConfig::Kind::attached;
  ring.nodes[2].cpu.kind = CpuConfig::Kind::attached;
  EXPECT_EQ(body_of(ring).id, 8);
}

}  // namespace
}  // namespace limb_ring::config
