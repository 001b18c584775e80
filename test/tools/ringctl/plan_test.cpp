// What `ringctl up` intends to start.
#include <gmock/gmock.h>

#include "config/quantity.h"
#include "support/own_folder.h"
#include "tools/ringctl/screen.h"
#include "tools/ringctl/up.h"

namespace limb_ring::ringctl {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
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
  EXPECT_THAT(plan.arguments_of(plan.nodes[2]), ElementsAre("--nodes", "3", "--ring", "plain", "--node", "2"));
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
  EXPECT_THAT(plan.arguments_of(plan.nodes[0]),
              ElementsAre("--config", request.config, "--as-read", EndsWith("limb_ring/other"), "--ring", "other",
                          "--transport", "udp", "--node", "4"));
}

TEST_F(Plan, ForeignNodesAreNotStarted) {
  UpRequest request;
  request.config = write("board.yaml",
                         "ring: board\nlinks: {transport: udp}\nnodes:\n  - {id: 0}\n"
                         "  - {id: 1, controller: foreign}\n  - {id: 2}\n");
  const RingPlan plan = plan_ring(request);
  ASSERT_EQ(plan.nodes.size(), 2u);
  EXPECT_EQ(plan.nodes[1].id, 2);
  EXPECT_TRUE(plan.is_part());
  request.clock = VirtualClock{};
  EXPECT_EQ(plan_ring(request).nodes.size(), 3u) << "a virtual ring has a node of ours in its place";
}

TEST_F(Plan, ARingOfOnlyForeignNodesIsRefused) {
  UpRequest request;
  request.config = write("boards.yaml",
                         "ring: boards\nlinks: {transport: udp}\nnodes:\n  - {id: 0, controller: foreign}\n"
                         "  - {id: 1, controller: foreign}\n");
  EXPECT_THROW(plan_ring(request), UsageError);
}

TEST_F(Plan, FolderTooLongForASocketIsRefusedBeforeAnythingStarts) {
  ::setenv("XDG_RUNTIME_DIR", ("/" + std::string(100, 'x')).c_str(), 1);
  EXPECT_THROW(plan_ring(plain(2)), UsageError);
}

TEST_F(Plan, RecordingsAreSavedOnlyIfSomethingIsRecorded) {
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

}  // namespace
}  // namespace limb_ring::ringctl
