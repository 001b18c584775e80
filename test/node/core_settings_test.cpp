// The settings of a network controller, from a ring's configuration.
#include "config/core_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/load_ring.h"

namespace limb_ring::setup {
namespace {

using namespace std::chrono_literals;

/// Four nodes, the lines into the last three with 40 ms of delay.
config::RingConfig uneven_ring() {
  config::RingConfig ring;
  for (std::uint8_t id = 0; id < 4; ++id) {
    config::NodeConfig node;
    node.id = id;
    if (id > 0) node.link.delay = 40ms;
    ring.nodes.push_back(node);
  }
  return ring;
}

TEST(CoreSettings, TheWorstLapIsOfAllLinesWhateverTheOwnIs) {
  const config::RingConfig ring = uneven_ring();
  for (const config::NodeConfig& node : ring.nodes) EXPECT_EQ(core_settings(ring, node, 1).worst_lap(), 120ms);
}

TEST(CoreSettings, ANodeMayHaveItsOwnNumberOfReceiveBuffers) {
  const config::RingConfig ring = config::parse_ring(
      "ring: r\nlimits: {receive_buffers: 5}\nnodes: [{id: 0, receive_buffers: 512}, {id: 1}]\n", "r.yaml");
  EXPECT_EQ(core_settings(ring, ring.nodes[0], 1).receive_buffers, 512u);
  EXPECT_EQ(core_settings(ring, ring.nodes[1], 1).receive_buffers, 5u);
}

// Each node's own delay was taken for all: 240 ms at the first node, 560 ms at the others.
TEST(CoreSettings, TheTimeOutOfAFoldedRingIsOfAllLinesToo) {
  const config::RingConfig ring = uneven_ring();
  for (const config::NodeConfig& node : ring.nodes) {
    core::Settings settings = core_settings(ring, node, 1);
    settings.fold_back = true;
    settings.send_timeout_least = core::Duration{0};
    EXPECT_EQ(settings.send_timeout(), 2 * (120ms + 120ms)) << "node " << int{node.id};
  }
}

// Node 5's line alone has a rate. All packets queue before it, and behind it they come at once if node 4 runs late.
TEST(CoreSettings, TheInsertionBufferAtALineWithARateHasRoomForAPacketOfEachNode) {
  std::string nodes;
  for (int id = 0; id < 16; ++id)
    nodes += "  - {id: " + std::to_string(id) + (id == 5 ? ", link: {rate: 20Mbit/s}}\n" : "}\n");
  config::RingConfig ring = config::parse_ring("ring: r\nnodes:\n" + nodes, "r.yaml");
  EXPECT_EQ(core_settings(ring, ring.nodes[4], 1).insertion_buffer, 16u);
  EXPECT_EQ(core_settings(ring, ring.nodes[5], 1).insertion_buffer, 16u);
  EXPECT_EQ(core_settings(ring, ring.nodes[6], 1).insertion_buffer, 8u);
  EXPECT_EQ(too_small_insertion_buffer(ring, ring.nodes[4]), "");
  ring.limits.insertion_buffer = 15;
  EXPECT_EQ(core_settings(ring, ring.nodes[4], 1).insertion_buffer, 15u);
  EXPECT_THAT(too_small_insertion_buffer(ring, ring.nodes[4]), testing::StartsWith("limits.insertion_buffer is 15: "));
  EXPECT_EQ(too_small_insertion_buffer(ring, ring.nodes[6]), "");
}

// Its hosts may lose each other, and each close a ring without the others. (protocol.md section 4.10)
TEST(CoreSettings, ARingOverSeveralHostsFallsIntoPartsAndOneOnASingleHostDoesNot) {
  config::RingConfig ring = uneven_ring();
  EXPECT_FALSE(core_settings(ring, ring.nodes[0], 1).falls_into_parts());
  ring.hosts.resize(1);
  EXPECT_FALSE(core_settings(ring, ring.nodes[0], 1).falls_into_parts());
  ring.hosts.resize(2);
  EXPECT_TRUE(core_settings(ring, ring.nodes[0], 1).falls_into_parts());
}

}  // namespace
}  // namespace limb_ring::setup
