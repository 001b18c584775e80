// Keys of UDP lines, and what lines are expected to do.
#include <gmock/gmock.h>

#include "config/load_ring.h"
#include "config/ring_config.h"

namespace limb_ring::config {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

std::string ring(const std::string& links, const std::string& more = "") {
  return "ring: r\nlinks: {" + links + "}\n" + more + "nodes:\n  - {id: 0}\n  - {id: 1}\n";
}

std::string problem(const std::string& text) {
  try {
    parse_ring(text, "/robot/ring.yaml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(LineKeys, UdpBeyondThisHostNeedsAKeyOrTheWordInsecure) {
  const std::string error = problem(ring("transport: udp, address: 192.168.0.2"));
  EXPECT_THAT(error, HasSubstr("line into node 'node0' comes by UDP to 192.168.0.2, beyond this host, and has no key"));
  EXPECT_THAT(error, HasSubstr("ringctl hosts key"));
  EXPECT_THAT(error, HasSubstr("insecure: true"));
  EXPECT_EQ(problem(ring("transport: udp, address: 192.168.0.2, key: ring.key")), "");
  EXPECT_EQ(problem(ring("transport: udp, address: 192.168.0.2, insecure: true")), "");
  EXPECT_EQ(problem(ring("transport: udp")), "");
  EXPECT_EQ(problem(ring("transport: udp, address: ::1")), "");
  EXPECT_EQ(problem(ring("transport: udp, address: '0:0:0:0:0:0:0:1'")), "") << "the same address";
  EXPECT_EQ(problem(ring("address: 192.168.0.2")), "");
  EXPECT_THAT(problem(ring("key: ring.key, insecure: true")), HasSubstr("one of the two"));
}

TEST(LineKeys, AnotherTransportFromTheCommandLineIsCheckedToo) {
  RingConfig other = parse_ring(ring("address: 192.168.0.2"), "/robot/ring.yaml");
  EXPECT_THROW(apply_transport(other, "udp"), ConfigError);
}

TEST(LineKeys, TheKeyIsLookedForBesideTheRingsFile) {
  EXPECT_EQ(parse_ring(ring("key: keys/ring.key"), "/robot/ring.yaml").links.key, "/robot/keys/ring.key");
  EXPECT_EQ(parse_ring(ring("key: /etc/ring.key"), "/robot/ring.yaml").links.key, "/etc/ring.key");
}

TEST(ExpectedOfALine, IsKeptApartFromWhatIsEmulated) {
  const RingConfig config = parse_ring(ring("delay: 1us, expected: {delay: 2ms, loss: 0.01}"), "r.yaml");
  EXPECT_EQ(config.nodes[1].link.delay, 1us);
  EXPECT_EQ(config.nodes[1].link.expected.delay, 2ms);
  EXPECT_EQ(config.nodes[1].link.expected.loss, 0.01);
  EXPECT_EQ(config.nodes[1].link.whole_delay(), 2001us);
}

TEST(ExpectedOfALine, HasToFitIntoTheSilence) {
  const std::string error = problem(ring("expected: {delay: 100ms}"));
  EXPECT_THAT(error, HasSubstr("takes 100ms one way, and timeouts.silence is only 250ms"));
  EXPECT_THAT(error, HasSubstr("at least 300ms"));
  EXPECT_EQ(problem(ring("expected: {delay: 100ms}", "timeouts: {silence: 300ms}\n")), "");
}

}  // namespace
}  // namespace limb_ring::config
