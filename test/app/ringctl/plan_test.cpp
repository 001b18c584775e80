// What `ringctl up` intends to start, and when it counts the ring as closed.
#include <gmock/gmock.h>

#include "app/ringctl/problems.h"
#include "app/ringctl/ring_plan.h"
#include "app/ringctl/ring_watch.h"
#include "config/config_error.h"
#include "support/own_folder.h"

namespace limb_ring::ringctl {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Plan = test::OwnFolder;

UpRequest plain(unsigned nodes) {
  UpRequest request;
  request.nodes = nodes;
  return request;
}

TEST_F(Plan, PlainRingNeedsNoFile) {
  const RingPlan plan = plan_ring(plain(3));
  EXPECT_EQ(plan.ring, "plain");
  ASSERT_EQ(plan.nodes.size(), 3u);
  EXPECT_THAT(plan.arguments_of(plan.nodes[2].node), ElementsAre("--nodes", "3", "--ring", "plain", "--node", "2"));
}

TEST_F(Plan, FileIsGivenToEveryDaemonByItsFullPath) {
  UpRequest request;
  request.config = write("two.yaml",
                         "ring: two\nnodes:\n  - {id: 4, name: a, cpu: {command: [x]}}\n"
                         "  - {id: 2, name: b, cpu: attached}\n");
  request.ring = "other";
  request.transport = "udp";
  const RingPlan plan = plan_ring(request);
  EXPECT_EQ(plan.ring, "other");
  EXPECT_TRUE(plan.nodes[0].has_child);
  EXPECT_FALSE(plan.nodes[1].has_child);
  EXPECT_THAT(plan.arguments_of(plan.nodes[0].node),
              ElementsAre("--config", request.config, "--ring", "other", "--transport", "udp", "--node", "4"));
}

TEST_F(Plan, FolderTooLongForASocketIsRefusedBeforeAnythingStarts) {
  ::setenv("XDG_RUNTIME_DIR", ("/" + std::string(100, 'x')).c_str(), 1);
  EXPECT_THROW(plan_ring(plain(2)), UsageError);
}

TEST_F(Plan, RecordingsAreSavedOnlyWhereSomethingIsRecorded) {
  UpRequest request;
  request.config = write("two.yaml",
                         "ring: two\nnodes:\n  - {id: 0, name: a}\n  - {id: 1, name: b}\n"
                         "recorder: {save: [crash], folder: saves}\n");
  try {
    plan_ring(request);
    ADD_FAILURE() << "accepted";
  } catch (const config::ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("entry 'recorder.save': nothing is recorded"));
  }
  request.record = true;
  EXPECT_FALSE(plan_ring(request).keeper.empty());
}

TEST_F(Plan, MissingFileIsAConfigurationError) {
  UpRequest request;
  request.config = folder + "/none.yaml";
  EXPECT_THROW(plan_ring(request), config::ConfigError);
}

json status(const char* state, unsigned size, const char* cpu) {
  return {{"state", state}, {"ring_size", size}, {"cpu", {{"state", cpu}}}};
}

const PlannedNode kWithChild{{0, "knee"}, true};
const PlannedNode kWithout{{0, "body"}, false};

TEST(Closed, NodeUpInAWholeRingLacksNothing) {
  EXPECT_EQ(missing(kWithout, status("up", 4, "absent"), 4), "");
  EXPECT_EQ(missing(kWithChild, status("up", 4, "running"), 4), "");
}

TEST(Closed, NodeSaysWhatItLacks) {
  EXPECT_THAT(missing(kWithout, status("joining", 4, "none"), 4), HasSubstr("joining"));
  EXPECT_THAT(missing(kWithout, status("up", 3, "none"), 4), HasSubstr("3 nodes, not 4"));
  EXPECT_THAT(missing(kWithChild, status("up", 4, "booting"), 4), HasSubstr("booting"));
}

TEST(Closed, CpuThatCannotBeStartedGivesItsReason) {
  json failed = status("up", 4, "failed");
  failed["cpu"]["last_exit"] = "no program 'x'";
  EXPECT_THAT(missing(kWithChild, failed, 4), HasSubstr("no program 'x'"));
}

}  // namespace
}  // namespace limb_ring::ringctl
