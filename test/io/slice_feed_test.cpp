#include "io/input.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>

#include "io/recording_handler.h"

namespace limb_ring::link {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using wire::SliceKind;

struct Feed : testing::Test {
  SliceFeed feed;
  RecordingInput handler;
  InputCounters counters;

  bool give(wire::ByteView bytes) {
    std::memcpy(feed.space(), bytes.data, bytes.size);
    return feed.commit(bytes.size, handler, counters);
  }
};

TEST_F(Feed, HandsAllOfOneReadOnAsOneBatch) {
  wire::SliceWriter writer;
  const std::vector<std::uint8_t> pin(12, 1), data(524, 2);
  writer.put(SliceKind::interrupt, {pin.data(), pin.size()});
  writer.put(SliceKind::idle, {});
  writer.put(SliceKind::whole, {data.data(), data.size()});
  ASSERT_TRUE(give(writer.view()));
  EXPECT_THAT(handler.slices, ElementsAre(pin, data));
  EXPECT_THAT(handler.log, ElementsAre("slice", "slice", "batch end"));
  EXPECT_EQ(counters.idle_slices, 1u);
}

TEST_F(Feed, PutsASliceTogetherThatIsCutAtAnyByte) {
  wire::SliceWriter writer;
  std::vector<std::uint8_t> data(524);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(i);
  writer.put(SliceKind::whole, {data.data(), data.size()});
  const wire::ByteView framed = writer.view();
  for (std::size_t cut = 1; cut < framed.size; ++cut) {
    handler = {};
    ASSERT_TRUE(give(framed.first(cut)));
    EXPECT_THAT(handler.log, IsEmpty());
    ASSERT_TRUE(give(framed.from(cut)));
    ASSERT_THAT(handler.slices, ElementsAre(data)) << "cut at " << cut;
  }
}

TEST_F(Feed, TakesFullReadsWithoutLosingTheirEnds) {
  wire::SliceWriter writer;
  for (int i = 0; i < 1000; ++i) {
    std::vector<std::uint8_t> data(13 + i % 512, static_cast<std::uint8_t>(i));
    writer.put(SliceKind::whole, {data.data(), data.size()});
  }
  wire::ByteView rest = writer.view();
  while (!rest.empty()) {
    const std::size_t some = std::min(rest.size, feed.space_size());
    ASSERT_TRUE(give(rest.first(some)));
    rest = rest.from(some);
  }
  ASSERT_EQ(handler.slices.size(), 1000u);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(handler.slices[i].size(), 13u + i % 512);
    ASSERT_EQ(handler.slices[i].back(), static_cast<std::uint8_t>(i));
  }
}

TEST_F(Feed, SaysWhyBytesAreNotASlice) {
  const std::vector<std::uint8_t> garbage{'G', 'E', 'T', ' ', '/'};
  EXPECT_FALSE(give({garbage.data(), garbage.size()}));
  EXPECT_THAT(handler.log, IsEmpty());
}

}  // namespace
}  // namespace limb_ring::link
