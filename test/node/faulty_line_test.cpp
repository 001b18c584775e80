// What a fault does to a line between two ends that are really there.
#include "node/engine.h"

#include <gmock/gmock.h>

#include "config/fault_parse.h"
#include "io/link_rig.h"
#include "support/node_literal.h"

namespace limb_ring::runtime {
namespace {

constexpr std::size_t kHeard = 2000;
const fault::RingNodes kNodes{{"hip", "0", 0_id}, {"knee", "1", 1_id}};

/// hip -> knee, over UDP.
struct FaultyLineTest : testing::Test {
  void SetUp() override {
    rig.start_all();
    ASSERT_TRUE(rig.until([&] { return rig.whole(); }));
    line = std::make_unique<FaultyLine>(rig.node(0).io, clock, *rig.node(0).output);
  }
  void begin(const std::string& words) { line->begin(fault::from_words(words, kNodes), clock.now()); }
  /// Whole slices with these numbers, all at once.
  void put(unsigned first, unsigned end) {
    wire::SliceWriter slices;
    for (unsigned number = first; number != end; ++number) {
      const std::uint8_t bytes[30] = {0, static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8)};
      slices.put(wire::SliceKind::whole, {bytes, sizeof bytes});
    }
    line->put(slices.view(), clock.now());
  }
  std::vector<unsigned> heard() {
    std::vector<unsigned> numbers;
    for (const auto& slice : rig.node(1).heard.slices) numbers.push_back(slice[1] | slice[2] << 8);
    return numbers;
  }

  /// Of the receiving end: what has come, and where it missed something.
  std::vector<std::string> told() {
    std::vector<std::string> told;
    auto slice = rig.node(1).heard.slices.begin();
    for (const std::string& entry : rig.node(1).heard.log) {
      if (entry == "slice") told.push_back(std::to_string((*slice)[1] | (*slice)[2] << 8)), ++slice;
      if (entry.rfind("gap", 0) == 0) told.push_back(entry);
    }
    return told;
  }

  link::LinkRig rig{2, link::Endpoint::Transport::udp};
  Clock clock;
  std::unique_ptr<FaultyLine> line;
};

TEST_F(FaultyLineTest, ADatagramThatIsLateIsMissedInItsPlace) {
  begin("reorder hip -> knee once_in=5 seed=2");
  put(0, 8);
  line->clear(clock.now());
  put(8, 9);
  ASSERT_TRUE(rig.until([&] { return !heard().empty() && heard().back() == 8; }));
  EXPECT_THAT(told(), testing::ElementsAre("0", "gap", "2", "3", "4", "gap", "6", "gap", "8"));
}

TEST_F(FaultyLineTest, ADatagramThatIsLateIsDiscardedWhereverItWasInABatch) {
  begin("reorder hip -> knee once_in=3 seed=1");
  for (unsigned first = 0; first != kHeard; first += 50) {
    put(first, first + 50);
    rig.run_for(link::milliseconds(1));
  }
  line->clear(clock.now());
  put(kHeard, kHeard + 1);
  ASSERT_TRUE(rig.until([&] { return !heard().empty() && heard().back() == kHeard; }));
  const std::vector<unsigned> numbers = heard();
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
  const std::uint64_t late = line->counters().line_reordered;
  EXPECT_GT(late, kHeard / 4);
  EXPECT_EQ(numbers.size() + late, kHeard + 1);
  EXPECT_EQ(rig.node(1).input->counters().datagrams_duplicate, late);
}

}  // namespace
}  // namespace limb_ring::runtime
