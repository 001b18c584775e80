#include "io/input.h"

#include <gmock/gmock.h>

#include "io/link_rig.h"
#include "support/run_until.h"

namespace limb_ring::link {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct LongLine : testing::Test {
  static constexpr std::size_t kSize = wire::kMaxDataPacketSize;
  boost::asio::io_context io;
  RecordingInput far_end;
  InputCounters counters;
  DelayedInput line{io, milliseconds(3), far_end, counters};

  bool until(const std::function<bool()>& condition) { return test::run_until(io, condition); }

  void give(std::uint8_t value) {
    const std::vector<std::uint8_t> bytes(kSize, value);
    line.on_slice({wire::SliceKind::whole, {bytes.data(), bytes.size()}});
  }
};

TEST_F(LongLine, HandsEverythingOnLaterAndInOrder) {
  const Time start = Clock::now();
  line.on_input_up(4);
  give(1);
  line.on_batch_end();
  line.on_input_gap();
  line.on_input_lost("gone");
  EXPECT_THAT(far_end.log, IsEmpty());
  ASSERT_TRUE(until([&] { return far_end.log.size() == 5; }));
  EXPECT_GE(Clock::now() - start, milliseconds(3));
  EXPECT_THAT(far_end.log, ElementsAre("up 4", "slice", "batch end", "gap", "lost: gone"));
  EXPECT_EQ(far_end.slices.front(), std::vector<std::uint8_t>(kSize, 1));
}

TEST_F(LongLine, KeepsOrderOverManyBatches) {
  for (int i = 0; i < 100; ++i) {
    give(static_cast<std::uint8_t>(i));
    io.restart();
    io.poll();
  }
  ASSERT_TRUE(until([&] { return far_end.slices.size() == 100; }));
  for (int i = 0; i < 100; ++i) EXPECT_EQ(far_end.slices[i].front(), i);
}

TEST_F(LongLine, DropsWhatDoesNotFitAndSaysSo) {
  const std::size_t fit = DelayedInput::kLimit / (wire::kSliceHeaderSize + kSize);
  for (std::size_t i = 0; i < fit + 3; ++i) give(1);
  EXPECT_EQ(counters.delay_dropped, 3u);
  ASSERT_TRUE(until([&] { return !far_end.log.empty() && far_end.log.back() == "gap"; }));
  EXPECT_EQ(far_end.slices.size(), fit);
}

TEST_F(LongLine, HoldsOneGapForAllThatDoesNotFit) {
  const std::size_t fit = DelayedInput::kLimit / (wire::kSliceHeaderSize + kSize);
  for (std::size_t i = 0; i < fit; ++i) give(1);
  for (int i = 0; i < 1000; ++i) {
    give(2);
    line.on_batch_end();
  }
  ASSERT_TRUE(until([&] { return !far_end.log.empty() && far_end.log.back() == "batch end"; }));
  ASSERT_EQ(far_end.log.size(), fit + 2);
  EXPECT_EQ(far_end.log[fit], "gap");
}

TEST_F(LongLine, SaysNothingAfterClosing) {
  give(1);
  line.close();
  io.run_for(milliseconds(10));
  EXPECT_THAT(far_end.log, IsEmpty());
}

TEST(DelayedLink, CarriesSlicesFromEndToEnd) {
  LinkRig rig(2, Endpoint::Transport::unix_stream);
  InputSettings settings = rig.input_settings(1);
  settings.delay = milliseconds(2);
  RigNode& node = rig.node(1);
  node.input = std::make_unique<Input>(node.io, settings, node.heard);
  rig.start_output(0);
  ASSERT_TRUE(rig.until([&] { return rig.linked(0, 1); }));
  wire::SliceWriter writer;
  for (int i = 0; i < 10; ++i) put_whole(writer, 524, static_cast<std::uint8_t>(i));
  rig.node(0).output->write(writer.view());
  ASSERT_TRUE(rig.until([&] { return node.heard.slices.size() == 10; }));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(node.heard.slices[i].front(), i);
}

}  // namespace
}  // namespace limb_ring::link
