#include "node/virtual_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/node_notes.h"
#include "support/own_folder.h"

namespace limb_ring::virtual_host {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using wire::NodeId;

/// What is done to nodes, and when.
struct Power final : NodePower {
  explicit Power(sim::VirtualRing& on) : ring(on) {}

  void off(NodeId node) override { note("off", node); }
  std::string on(NodeId node) override {
    note("on", node);
    return problem;
  }
  void freeze(NodeId node, bool clock_stands) override { note(clock_stands ? "suspend" : "freeze", node); }
  void thaw(NodeId node) override { note("thaw", node); }
  void note(const std::string& what, NodeId node) {
    done.push_back(what + ' ' + std::to_string(node));
    at.push_back(std::chrono::duration_cast<std::chrono::milliseconds>(ring.now().time_since_epoch()));
  }

  sim::VirtualRing& ring;
  std::string problem;
  std::vector<std::string> done;
  std::vector<std::chrono::milliseconds> at;
};

struct NodeFaultsTest : test::OwnFolder {
  std::string begin(const std::string& words) { return faults.begin(fault::from_words(words, nodes)); }
  std::string noted(std::uint8_t node) {
    const auto note = live::note_of(folder, NodeId{node});
    return note ? note->words : "";
  }

  sim::VirtualRing ring{sim::VirtualRingOptions{}};
  Power power{ring};
  fault::RingNodes nodes{{"body", "0", NodeId{0}}, {"hip", "1", NodeId{1}}, {"knee", "2", NodeId{2}}};
  NodeFaults faults{ring, power, nodes, folder};
};

TEST_F(NodeFaultsTest, AKilledNodeIsNotedUntilItIsStarted) {
  EXPECT_EQ(begin("kill hip knee"), "");
  EXPECT_TRUE(faults.is_dead(NodeId{1}));
  EXPECT_EQ(noted(1), "kill hip");
  EXPECT_EQ(begin("start hip"), "");
  EXPECT_FALSE(faults.is_dead(NodeId{1}));
  EXPECT_EQ(noted(1), "");
  EXPECT_EQ(noted(2), "kill knee");
  EXPECT_THAT(power.done, ElementsAre("off 1", "off 2", "on 1"));
}

TEST_F(NodeFaultsTest, WhatCannotBeDoneToOneIsDoneToNone) {
  ASSERT_EQ(begin("kill knee"), "");
  power.done.clear();
  EXPECT_THAT(begin("kill hip knee"), HasSubstr("knee is dead"));
  EXPECT_THAT(begin("freeze hip knee"), HasSubstr("knee is dead"));
  EXPECT_THAT(begin("thaw knee"), HasSubstr("knee is dead"));
  EXPECT_THAT(begin("power_cycle all"), HasSubstr("knee is dead"));
  EXPECT_THAT(begin("start all"), HasSubstr("body runs already"));
  EXPECT_THAT(power.done, ElementsAre());
}

TEST_F(NodeFaultsTest, AllNodesAreOffBeforeTheFirstIsOnAgain) {
  EXPECT_EQ(begin("power_cycle hip knee"), "");
  EXPECT_THAT(power.done, ElementsAre("off 1", "off 2", "on 1", "on 2"));
  EXPECT_EQ(noted(1), "");
}

TEST_F(NodeFaultsTest, ANodeThatDoesNotStartStaysDead) {
  power.problem = "no more sockets";
  EXPECT_THAT(begin("power_cycle hip"), HasSubstr("hip does not start: no more sockets"));
  EXPECT_TRUE(faults.is_dead(NodeId{1}));
  EXPECT_THAT(noted(1), HasSubstr("hip"));
  power.problem.clear();
  EXPECT_EQ(begin("start hip"), "");
}

TEST_F(NodeFaultsTest, AFreezeEndsWithItsTimeOrByAThawButNotWithTheTimeOfAnEarlierOne) {
  EXPECT_EQ(begin("freeze hip for=10ms"), "");
  EXPECT_TRUE(faults.is_frozen(NodeId{1}));
  EXPECT_EQ(noted(1), "freeze hip for=10ms");
  EXPECT_EQ(begin("thaw hip"), "");
  EXPECT_EQ(noted(1), "");
  EXPECT_EQ(begin("thaw hip"), "") << "nothing is to be done";
  EXPECT_EQ(begin("freeze hip for=30ms"), "");
  ring.run_until(core::Time{} + 100ms);
  EXPECT_FALSE(faults.is_frozen(NodeId{1}));
  EXPECT_THAT(power.done, ElementsAre("freeze 1", "thaw 1", "freeze 1", "thaw 1"));
  EXPECT_THAT(power.at, ElementsAre(0ms, 0ms, 0ms, 30ms));
}

TEST_F(NodeFaultsTest, AFrozenNodeIsKilledForGood) {
  EXPECT_EQ(begin("freeze hip for=10ms"), "");
  EXPECT_THAT(begin("power_cycle hip"), HasSubstr("hip is frozen"));
  EXPECT_EQ(begin("kill hip"), "");
  EXPECT_EQ(noted(1), "kill hip");
  ring.run_until(core::Time{} + 100ms);
  EXPECT_TRUE(faults.is_dead(NodeId{1}));
  EXPECT_THAT(power.done, ElementsAre("freeze 1", "off 1"));
}

TEST_F(NodeFaultsTest, ASuspendedNodeIsFrozenAndItsClockStands) {
  EXPECT_EQ(begin("suspend hip for=10ms"), "");
  EXPECT_TRUE(faults.is_frozen(NodeId{1}));
  EXPECT_EQ(noted(1), "suspend hip for=10ms");
  ring.run_until(core::Time{} + 100ms);
  EXPECT_THAT(power.done, ElementsAre("suspend 1", "thaw 1"));
}

TEST_F(NodeFaultsTest, ClocksAreSetAlsoWhereTheNodeIsDead) {
  ASSERT_EQ(begin("kill knee"), "");
  EXPECT_EQ(begin("step_clock hip knee monotonic=3ms back=1s"), "");
  EXPECT_EQ(ring.time_of(NodeId{1}), ring.now() + 3ms);
  EXPECT_EQ(ring.time_of(NodeId{0}), ring.now());
  EXPECT_EQ(noted(1), "");
}

TEST_F(NodeFaultsTest, WhatCannotBeNotedIsNotDone) {
  ASSERT_TRUE(std::filesystem::create_directory(folder + "/2.fault"));  // nobody can write there
  EXPECT_THAT(begin("kill hip knee"), HasSubstr("2.fault: Is a directory"));
  EXPECT_THAT(power.done, ElementsAre());
  EXPECT_EQ(noted(1), "");
}

TEST_F(NodeFaultsTest, NotesOfAnEarlierRingAreRemoved) {
  ASSERT_EQ(live::write_note(folder, NodeId{2}, "kill knee"), "");
  const NodeFaults next(ring, power, nodes, folder);
  EXPECT_EQ(noted(2), "");
}

}  // namespace
}  // namespace limb_ring::virtual_host
