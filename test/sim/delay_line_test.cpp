#include "sim/delay_line.h"
#include "support/node_literal.h"

#include <gtest/gtest.h>

namespace limb_ring::sim {
namespace {

using namespace std::chrono_literals;

wire::SliceWriter slice_of(std::uint8_t byte) {
  wire::SliceWriter slices;
  slices.put(wire::SliceKind::start, wire::ByteView{&byte, 1});
  return slices;
}

TEST(DelayLine, IsEmptyAtFirst) {
  const DelayLine line(512ns);
  EXPECT_TRUE(line.empty());
  EXPECT_EQ(line.next(), core::kNever);
}

TEST(DelayLine, GivesOutWhatLeftADelayLater) {
  DelayLine line(512ns);
  wire::SliceWriter slices = slice_of(7);
  line.put(Time(100ns), 1_id, 2_id, 5, core::Line::second, slices);
  EXPECT_TRUE(slices.empty()) << "it was taken, not copied";
  EXPECT_EQ(line.next(), Time(612ns));
  const DelayLine::Arrival& arrival = line.pop();
  EXPECT_EQ(arrival.from, 1);
  EXPECT_EQ(arrival.to, 2);
  EXPECT_EQ(arrival.epoch, 5u);
  EXPECT_EQ(arrival.line, core::Line::second);
  EXPECT_FALSE(arrival.slices.empty());
  EXPECT_TRUE(line.empty());
}

TEST(DelayLine, KeepsTheOrderHoweverMuchIsUnderWay) {
  DelayLine line(1us);
  unsigned given_out = 0;
  for (unsigned i = 0; i < 1000; ++i) {
    wire::SliceWriter slices = slice_of(0);
    line.put(Time(i * 1ns), 0_id, 1_id, i, core::Line::first, slices);
    if (i % 3 != 0) continue;
    EXPECT_EQ(line.pop().epoch, given_out++);
  }
  while (!line.empty()) EXPECT_EQ(line.pop().epoch, given_out++);
  EXPECT_EQ(given_out, 1000u);
}

}  // namespace
}  // namespace limb_ring::sim
