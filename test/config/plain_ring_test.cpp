#include "config/ring_config.h"

#include <gtest/gtest.h>

#include <set>

namespace limb_ring::config {
namespace {

TEST(PlainRing, HasNodesWithoutCpusAndDefaultsElsewhere) {
  const RingConfig ring = plain_ring("bench", 3);
  EXPECT_EQ(ring.ring, "bench");
  EXPECT_EQ(ring.path, "");
  ASSERT_EQ(ring.nodes.size(), 3u);
  for (unsigned i = 0; i < 3; ++i) {
    EXPECT_EQ(ring.nodes[i].id, i);
    EXPECT_EQ(ring.nodes[i].name, "node" + std::to_string(i));
    EXPECT_EQ(ring.nodes[i].cpu.kind, CpuConfig::Kind::none);
    EXPECT_EQ(ring.nodes[i].pins[0].action, PinConfig::Action::reset);
    EXPECT_EQ(ring.nodes[i].link.port, ring.links.port + i);
  }
}

TEST(PlainRing, HasTwoTo255Nodes) {
  EXPECT_EQ(plain_ring("r", 2).nodes.size(), 2u);
  EXPECT_EQ(plain_ring("r", 255).nodes.back().id, 254);
  EXPECT_THROW(plain_ring("r", 0), ConfigError);
  EXPECT_THROW(plain_ring("r", 1), ConfigError);
  EXPECT_THROW(plain_ring("r", 256), ConfigError);
  EXPECT_THROW(plain_ring("a/b", 2), ConfigError);
}

TEST(PlainRing, TransportIsThatOfTheCommandLine) {
  RingConfig ring = plain_ring("r", 2);
  apply_transport(ring, "udp");
  for (const NodeConfig& node : ring.nodes) EXPECT_EQ(node.link.transport, LinkConfig::Transport::udp);
  apply_transport(ring, "unix");
  EXPECT_EQ(ring.nodes[1].link.transport, LinkConfig::Transport::unix_stream);
  EXPECT_THROW(apply_transport(ring, "tcp"), ConfigError);
}

TEST(PlainRing, PortsDifferByTheRingsNameAndStayBelowTheSystemsOwn) {
  std::set<unsigned> ports;
  for (const char* name : {"a", "b", "left", "right", "humanoid16", "plain4"}) {
    ports.insert(default_first_port(name));
    EXPECT_GE(default_first_port(name), 17000);
    EXPECT_LE(default_first_port(name) + 254, 32767);
  }
  EXPECT_GE(ports.size(), 5u);
}

}  // namespace
}  // namespace limb_ring::config
