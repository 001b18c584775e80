// Where the nodes of several hosts listen for each other.
#include "node/link_settings.h"

#include <gtest/gtest.h>

namespace limb_ring::setup {
namespace {

using Transport = link::Endpoint::Transport;

/// Nodes 0 and 1 at the first host, 2 and 3 at the second.
config::RingConfig two_hosts() {
  config::RingConfig ring;
  ring.ring = "robot";
  ring.redundancy = config::RingConfig::Redundancy::foldback;
  ring.hosts = {{"waist", "10.0.0.1", ""}, {"head", "10.0.0.2", ""}};
  for (std::uint8_t id = 0; id < 4; ++id) {
    config::NodeConfig node;
    node.id = id;
    node.host = id / 2u;
    node.link.address = ring.hosts[node.host].address;
    node.link.port = static_cast<std::uint16_t>(20000 + id);
    ring.nodes.push_back(node);
  }
  return ring;
}

TEST(LinkSettings, EveryNodeListensForItsHostAndForTheOthers) {
  const config::RingConfig ring = two_hosts();
  for (const config::NodeConfig& node : ring.nodes) {
    const LinkSettings first = link_settings(ring, node, "/run/robot")[0];
    EXPECT_EQ(first.input.endpoint.transport, Transport::shm);
    ASSERT_TRUE(first.input.from_hosts);
    EXPECT_EQ(to_string(*first.input.from_hosts), node.link.address + ":" + std::to_string(20000 + node.id));
  }
}

TEST(LinkSettings, CandidatesAreReachedLocallyOrByUdp) {
  const config::RingConfig ring = two_hosts();
  const auto lines = link_settings(ring, ring.nodes[1], "/run/robot");
  std::vector<std::string> first, second;
  for (const link::Candidate& candidate : lines[0].output.candidates) first.push_back(to_string(candidate.endpoint));
  for (const link::Candidate& candidate : lines[1].output.candidates) second.push_back(to_string(candidate.endpoint));
  EXPECT_EQ(first,
            (std::vector<std::string>{"10.0.0.2:20002", "10.0.0.2:20003", "/run/robot/0.link", "/run/robot/1.link"}));
  EXPECT_EQ(second,
            (std::vector<std::string>{"/run/robot/0.link2", "10.0.0.2:20259", "10.0.0.2:20258", "/run/robot/1.link2"}));
}

TEST(LinkSettings, OneHostListensInOneWay) {
  config::RingConfig ring = two_hosts();
  for (config::NodeConfig& node : ring.nodes) node.host = 0;
  EXPECT_FALSE(link_settings(ring, ring.nodes[0], "/run/robot")[0].input.from_hosts);
}

TEST(LinkSettings, NodeWhoseLinesAreAllUdpHasOneEndpoint) {
  config::RingConfig ring = two_hosts();
  ring.nodes[0].link.transport = config::LinkConfig::Transport::udp;
  const LinkSettings first = link_settings(ring, ring.nodes[0], "/run/robot")[0];
  EXPECT_EQ(first.input.endpoint.transport, Transport::udp);
  EXPECT_FALSE(first.input.from_hosts);
}

}  // namespace
}  // namespace limb_ring::setup
