#include "config/ring_text.h"

namespace limb_ring::config {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using Policy = SupervisorConfig::Policy;

RingConfig read_with(const std::string& more) { return parse_ring(two_nodes(more), "ring.yaml"); }

TEST(Supervisor, ReportsByDefault) {
  const SupervisorConfig supervisor = read_with("").supervisor;
  EXPECT_EQ(supervisor.policy, Policy::report);
  EXPECT_EQ(supervisor.grace, 5s);
  EXPECT_EQ(supervisor.tries, 3u);
  EXPECT_EQ(supervisor.backoff, 1s);
}

TEST(Supervisor, IsWhatTheFileSays) {
  const SupervisorConfig supervisor =
      read_with("supervisor: {node: knee, policy: auto, grace: 300ms, tries: 5, backoff: 2s}\n").supervisor;
  EXPECT_EQ(supervisor.node, 1);
  EXPECT_EQ(supervisor.policy, Policy::automatic);
  EXPECT_EQ(supervisor.grace, 300ms);
  EXPECT_EQ(supervisor.tries, 5u);
  EXPECT_EQ(supervisor.backoff, 2s);
  EXPECT_EQ(read_with("supervisor: {policy: off}\n").supervisor.policy, Policy::off);
}

TEST(Supervisor, IsTheBodysNodeIfNoneIsNamed) {
  RingConfig ring = read_with("");
  EXPECT_EQ(supervisor_of(ring).name, "body");  // the first, for want of an attached CPU
  ring.nodes[1].cpu.kind = CpuConfig::Kind::attached;
  EXPECT_EQ(supervisor_of(ring).name, "knee");
  ring.supervisor.node = 0;
  EXPECT_EQ(supervisor_of(ring).name, "body");
}

TEST(Supervisor, OfAnUnknownNodeOrPolicyIsRefused) {
  EXPECT_THAT(
      refusal_of(two_nodes("supervisor: {node: kne}\n")),
      StartsWith("ring.yaml:6:20: entry 'supervisor.node': 'kne' is not a node of this ring, did you mean 'knee'?"));
  EXPECT_THAT(refusal_of(two_nodes("supervisor: {policy: always}\n")),
              HasSubstr("'supervisor.policy': 'always' is unknown; allowed: off, report, auto"));
  EXPECT_THAT(refusal_of(two_nodes("supervisor: {tries: 0}\n")),
              HasSubstr("'0' is out of range; allowed: a whole number, 1 to 10"));
  EXPECT_THAT(refusal_of(two_nodes("supervisor: {retries: 1}\n")), HasSubstr("did you mean 'tries'?"));
}

TEST(Supervisor, CannotResetACpuWithoutAResetPin) {
  const std::string unwired = "    cpu: {command: [a], alive_period: 1s}\n    pins: {0: none}\n";
  EXPECT_THAT(refusal_of(node_with(unwired + "supervisor: {policy: auto}\n")),
              StartsWith("ring.yaml:4:5: entry 'nodes[1]': its cpu has an alive_period, but no pin of it is wired "
                         "to reset; allowed: a pin wired to reset, or a supervisor with policy report or off"));
  EXPECT_THAT(refusal_of(node_with(unwired)), IsEmpty());
}

}  // namespace
}  // namespace limb_ring::config
