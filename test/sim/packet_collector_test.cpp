#include "judge/forwarding_checker.h"

#include <gtest/gtest.h>

#include <vector>

namespace limb_ring::sim {
namespace {

using namespace std::chrono_literals;
using core::Time;

struct PacketCollectorTest : testing::Test {
  PacketCollector collector{50us};
  wire::ByteView put(wire::SliceKind kind, std::size_t size, Time now) {
    bytes.assign(size, 0x55);
    return collector.put({kind, {bytes.data(), bytes.size()}}, now);
  }
  std::vector<std::uint8_t> bytes;
};

TEST_F(PacketCollectorTest, PutsTogetherWhatComesInSlices) {
  EXPECT_TRUE(put(wire::SliceKind::start, 4, Time(0us)).empty());
  EXPECT_TRUE(put(wire::SliceKind::more, 8, Time(1us)).empty());
  EXPECT_EQ(put(wire::SliceKind::end, 10, Time(2us)).size, 22u);
  EXPECT_FALSE(collector.open());
}

// The core takes what comes in at an instant before it looks at its deadlines.
TEST_F(PacketCollectorTest, ASliceInTheInstantOfTheDeadlineStillBelongsToThePacket) {
  put(wire::SliceKind::start, 4, Time(0us));
  EXPECT_FALSE(collector.stalled(Time(50us)));
  EXPECT_TRUE(collector.stalled(Time(50us + 1ns)));
}

TEST_F(PacketCollectorTest, GivesUpWhatIsTooLong) {
  put(wire::SliceKind::start, 4, Time(0us));
  put(wire::SliceKind::more, wire::kMaxPayload / 4 * 4, Time(0us));
  put(wire::SliceKind::more, 4, Time(0us));
  EXPECT_FALSE(collector.open());
}

}  // namespace
}  // namespace limb_ring::sim
