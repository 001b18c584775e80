// Which machine runs which node, and what the lines between them are.
#include "config/ring_config.h"
#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using ::testing::AllOf;
using ::testing::Eq;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Hosts waist and head; nodes body and knee there, eye at head. `links` stand in line 5.
std::string two_hosts(const std::string& links = "links: {insecure: true}", const std::string& of_knee = "",
                      const std::string& of_eye = "") {
  return "ring: robot\n"
         "hosts:\n"
         "  - {name: waist, address: 10.0.0.1}\n"
         "  - {name: head, address: 10.0.0.2, ssh: robot@head}\n" +
         links +
         "\n"
         "nodes:\n"
         "  - {id: 0, name: body, host: waist}\n"
         "  - {id: 1, name: knee" +
         of_knee +
         "}\n"
         "  - {id: 2, name: eye, host: head" +
         of_eye + "}\n";
}

TEST(Hosts, NodeIsAtTheFirstOneUnlessItSaysOtherwise) {
  const RingConfig ring = read(two_hosts());
  ASSERT_EQ(ring.hosts.size(), 2u);
  EXPECT_EQ(ring.host_of(*ring.find("knee"))->name, "waist");
  EXPECT_EQ(ring.host_of(*ring.find("eye"))->name, "head");
  EXPECT_EQ(ring.hosts[0].ssh_destination(), "10.0.0.1");
  EXPECT_EQ(ring.hosts[1].ssh_destination(), "robot@head");
  EXPECT_EQ(read(two_nodes()).host_of(read(two_nodes()).nodes[0]), nullptr);
}

TEST(Hosts, LineWithinOneIsLocalAndBetweenTwoUdp) {
  const RingConfig ring = read(two_hosts("links: {transport: unix, insecure: true}"));
  const NodeConfig &body = ring.nodes[0], &knee = ring.nodes[1], &eye = ring.nodes[2];
  EXPECT_EQ(transport_between(body, knee), LinkConfig::Transport::unix_stream);
  EXPECT_EQ(transport_between(knee, eye), LinkConfig::Transport::udp);
  EXPECT_EQ(transport_between(eye, body), LinkConfig::Transport::udp);
  EXPECT_EQ(transport_between(eye, eye), LinkConfig::Transport::unix_stream);
}

TEST(Hosts, NodeListensAtTheAddressOfItsHostOrAtItsOwn) {
  const RingConfig ring = read(two_hosts("links: {port: 20000, insecure: true}", "", ", link: {address: 10.0.1.2}"));
  EXPECT_EQ(ring.nodes[1].link.address, "10.0.0.1");
  EXPECT_EQ(ring.nodes[1].link.port, 20001);
  EXPECT_EQ(ring.nodes[2].link.address, "10.0.1.2") << "a second network interface";
}

TEST(Hosts, OfARobotCanAllBeOneHostAtADesk) {
  RingConfig ring = read(two_hosts());
  apply_one_host(ring);
  EXPECT_TRUE(ring.hosts.empty());
  EXPECT_EQ(transport_between(ring.nodes[1], ring.nodes[2]), LinkConfig::Transport::shm);
  EXPECT_EQ(ring.nodes[2].link.address, "127.0.0.1");
}

TEST(WrongHosts, AreNamedWithPlaceValueAndWhatIsRight) {
  EXPECT_THAT(
      refusal_of(two_hosts("links: {insecure: true}", ", host: haed")),
      Eq("ring.yaml:8:31: entry 'nodes[1].host': 'haed' is not a host of this ring, did you mean 'head'?; allowed: a "
         "host of this ring (head, waist)"));
  EXPECT_THAT(refusal_of(node_with("    host: head\n")),
              HasSubstr("'head' is not a host of this ring; allowed: no `host`, because the file has no `hosts`"));
  EXPECT_THAT(refusal_of("ring: r\nhosts: [{name: a, address: waist.local}]\nnodes: []\n"),
              AllOf(StartsWith("ring.yaml:2:28: entry 'hosts[0].address'"), HasSubstr("is not an address in numbers")));
  EXPECT_THAT(refusal_of("ring: r\nhosts: [{name: all, address: 10.0.0.1}]\nnodes: []\n"), HasSubstr("the word 'all'"));
  EXPECT_THAT(refusal_of("ring: r\nhosts: []\nnodes: []\n"), HasSubstr("a list of 1 to 255 maps"));
  EXPECT_THAT(refusal_of("ring: r\nhosts: [{name: a, address: 10.0.0.1, ssh: -oProxyCommand=x}]\nnodes: []\n"),
              HasSubstr("a destination as ssh takes it"));
}

TEST(WrongHosts, ThatShareANameOrAnAddress) {
  const std::string nodes = "nodes: [{id: 0}, {id: 1}]\n";
  EXPECT_THAT(refusal_of("ring: r\nhosts: [{name: a, address: 10.0.0.1}, {name: a, address: 10.0.0.2}]\n" + nodes),
              HasSubstr("'a' is the name of another host"));
  EXPECT_THAT(refusal_of("ring: r\nhosts: [{name: a, address: 10.0.0.1}, {name: b, address: 10.0.0.1}]\n" + nodes),
              HasSubstr("'10.0.0.1' is the address of another host"));
  EXPECT_THAT(
      refusal_of("ring: r\nhosts: [{name: a, address: 10.0.0.1}, {name: b, address: 127.0.0.1}]\n" + nodes),
      AllOf(StartsWith("ring.yaml:2:"), HasSubstr("'127.0.0.1' of host 'b' can be reached only from that machine")));
}

TEST(WrongHosts, ContradictedByTheLinks) {
  EXPECT_THAT(refusal_of(two_hosts("links: {address: 10.0.0.1}")),
              AllOf(StartsWith("ring.yaml:5:18: entry 'links.address'"),
                    HasSubstr("would be the address of all hosts; allowed: no address in `links`")));
  EXPECT_THAT(
      refusal_of(two_hosts("links: {insecure: true}", "", ", link: {transport: shm}")),
      AllOf(StartsWith("ring.yaml:9:"), HasSubstr("'shm' stays within a host, but the line into this node comes "
                                                  "from node 'knee' at host 'waist'; allowed: udp")));
  EXPECT_THAT(refusal_of(two_hosts("links: {insecure: true}", "", ", link: {address: 10.0.0.1}")),
              HasSubstr("'10.0.0.1' is the address of host 'waist', and this node is at host 'head'"));
  EXPECT_EQ(refusal_of(two_hosts("links: {insecure: true}", ", link: {transport: unix}", ", link: {transport: udp}")),
            "");
}

}  // namespace
}  // namespace limb_ring::config
