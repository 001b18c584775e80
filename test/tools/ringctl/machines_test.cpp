#include <gmock/gmock.h>

#include "config/load_ring.h"
#include "tools/ringctl/hosts.h"

namespace limb_ring::ringctl {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

config::RingConfig two_hosts(const std::string& ssh_of_head = "") {
  return config::parse_ring(
      "ring: robot\n"
      "hosts:\n"
      "  - {name: waist, address: 127.0.0.2}\n"
      "  - {name: head, address: 127.0.0.3" +
          ssh_of_head +
          "}\n"
          "nodes:\n"
          "  - {id: 0, name: body}\n"
          "  - {id: 1, name: neck, host: head, cpu: attached}\n",
      "robot.yaml");
}

TEST(MachinesFile, HasAMachineAndItsPartOfTheRingForEachHost) {
  const std::string file = machines_file(two_hosts(), "/opt/env.sh", "");
  EXPECT_THAT(file,
              HasSubstr("<machine name=\"waist\" address=\"127.0.0.2\" env-loader=\"/opt/env.sh\" timeout=\"30\"/>\n"
                        "  <include file=\"$(find limb_ring)/launch/host.launch\" pass_all_args=\"true\">\n"
                        "    <arg name=\"host\" value=\"waist\"/>\n"
                        "    <arg name=\"has_bridge\" value=\"false\"/>\n"
                        "  </include>\n"));
  EXPECT_THAT(file, HasSubstr("<arg name=\"host\" value=\"head\"/>\n    <arg name=\"has_bridge\" value=\"true\"/>"));
}

TEST(MachinesFile, LogsInAsTheHostSaysElseAsTheOptionSays) {
  EXPECT_THAT(machines_file(two_hosts(), "e", ""), Not(HasSubstr(" user=")));
  EXPECT_THAT(machines_file(two_hosts(", ssh: robot@head.local"), "e", "me"),
              AllOf(HasSubstr("name=\"waist\" address=\"127.0.0.2\" user=\"me\""),
                    HasSubstr("name=\"head\" address=\"head.local\" user=\"robot\"")));
}

TEST(MachinesFile, LeavesOutAHostWithoutNodesAndEscapesItsArguments) {
  auto ring = two_hosts();
  ring.nodes.pop_back();
  const std::string file = machines_file(ring, "/a \"b\" & <c>", "");
  EXPECT_THAT(file, AllOf(Not(HasSubstr("head")), HasSubstr("env-loader=\"/a &quot;b&quot; &amp; &lt;c&gt;\"")));
}

/// In a comment of XML two hyphens may not stand.
TEST(MachinesFile, IsXmlAlsoForARingWithHyphensInItsName) {
  auto ring = two_hosts();
  ring.ring = "my--robot";
  EXPECT_THAT(machines_file(ring, "e", ""), Not(HasSubstr("my--robot")));
}

TEST(MachinesFile, NeedsHosts) {
  const auto ring = config::parse_ring("ring: r\nnodes: [{id: 0}, {id: 1}]\n", "plain.yaml");
  EXPECT_THROW(machines_file(ring, "e", ""), std::invalid_argument);
}

TEST(MachinesFile, UsesAnEnvironmentLoaderThatExists) {
  EXPECT_EQ(usual_env_loader("/nowhere:/usr"), "/usr/bin/env");
  EXPECT_EQ(usual_env_loader(""), "/usr/bin/env");
}

}  // namespace
}  // namespace limb_ring::ringctl
