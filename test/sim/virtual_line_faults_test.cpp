#include "sim/virtual_line_faults.h"

#include <gtest/gtest.h>

#include "support/node_literal.h"

namespace limb_ring::sim {
namespace {

using core::Line;
using std::chrono::milliseconds;

/// A ring of 8 that folds back, with the cable between nodes 2 and 3 in the hands of the test.
struct CableOfAFoldingRing : testing::Test {
  VirtualRing ring{options()};
  VirtualLineFaults faults{ring, 1};
  fault::LineFaults::Id first = 0, second = 0;

  static VirtualRingOptions options() {
    VirtualRingOptions options;
    options.nodes = 8;
    options.adjust = [](core::Settings& settings) { settings.fold_back = true; };
    return options;
  }
  void SetUp() override {
    faults.tap_all();
    ASSERT_TRUE(ring.join());
  }
  void cut_first() { first = faults.begin(2_id, Line::first, fault::Fault{}); }
  void cut_second() { second = faults.begin(3_id, Line::second, fault::Fault{}); }
  core::Outcome sent_across() {
    const std::uint32_t token = ring.send(0_id, 5_id, {1, 2, 3});
    EXPECT_TRUE(ring.run_until([&] { return ring.ended(0_id, token) != nullptr; }, std::chrono::seconds(2)));
    const core::SendEnded* ended = ring.ended(0_id, token);
    return ended ? ended->outcome : core::Outcome::lost;
  }
  void let_it_settle() { ring.run_until(ring.now() + milliseconds(500)); }
};

TEST_F(CableOfAFoldingRing, IsFoldedAroundIfBothItsWiresAreCutInOneInstant) {
  cut_first();
  cut_second();
  let_it_settle();
  EXPECT_EQ(sent_across(), core::Outcome::delivered);
}

TEST_F(CableOfAFoldingRing, IsFoldedAroundIfTheSecondWireIsCutBefore) {
  cut_second();
  let_it_settle();
  cut_first();
  let_it_settle();
  EXPECT_EQ(sent_across(), core::Outcome::delivered);
}

TEST_F(CableOfAFoldingRing, IsTakenAgainOnceItIsMended) {
  cut_first();
  cut_second();
  let_it_settle();
  faults.remove(3_id, Line::second, second);
  faults.remove(2_id, Line::first, first);
  let_it_settle();
  EXPECT_EQ(sent_across(), core::Outcome::delivered);
  for (const wire::NodeId node : ring.order())
    EXPECT_EQ(ring.node(node).membership().state(), core::NodeState::up) << unsigned{node};
}

}  // namespace
}  // namespace limb_ring::sim
