#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Redundancy = RingConfig::Redundancy;

TEST(Redundancy, IsNoneUnlessTheFileSaysFoldback) {
  EXPECT_EQ(parse_ring(two_nodes(), "ring.yaml").redundancy, Redundancy::none);
  EXPECT_EQ(parse_ring(two_nodes("redundancy: foldback\n"), "ring.yaml").redundancy, Redundancy::foldback);
}

TEST(Redundancy, RefusesEverythingElse) {
  EXPECT_THAT(refusal_of(two_nodes("redundancy: double\n")),
              HasSubstr("'redundancy': 'double' is unknown; allowed: none, foldback"));
}

/// The nodes at two ports, with or without a second line.
std::string at_ports(unsigned first, unsigned second, const std::string& redundancy) {
  return "ring: r\nredundancy: " + redundancy + "\nnodes:\n  - {id: 0, name: a, link: {port: " + std::to_string(first) +
         "}}\n  - {id: 1, name: b, link: {port: " + std::to_string(second) + "}}\n";
}

TEST(Redundancy, NeedsPortsForTheSecondLineToo) {
  EXPECT_NO_THROW(parse_ring(at_ports(5000, 5256, "none"), "ring.yaml"));
  EXPECT_THAT(refusal_of(at_ports(5000, 5256, "foldback")),
              StartsWith("ring.yaml:5:5: entry 'nodes[1]': its link listens at 127.0.0.1 port 5256, as does node 'a'"));
  EXPECT_THAT(refusal_of(at_ports(5000, 65300, "foldback")), HasSubstr("port 65556; allowed: a port of at most 65279"));
}

}  // namespace
}  // namespace limb_ring::config
