#include "client/frame.h"

#include <gtest/gtest.h>

#include "support/view.h"

namespace limb_ring::client {
namespace {

using test::view;

TEST(Frame, HasItsSizeItsTypeAndItsBody) {
  Bytes out;
  FrameWriter(out, 7).u8(1).u16(0x0203).u32(0x04050607).text("ab").rest(std::string_view("c"));
  const Bytes golden{0, 0, 0, 13, 7, 1, 2, 3, 4, 5, 6, 7, 0, 2, 'a', 'b', 'c'};
  EXPECT_EQ(out, golden);
}

TEST(Frame, IsIncompleteUntilItsLastByte) {
  Bytes out;
  FrameWriter(out, 7).rest(std::string_view("body"));
  for (std::size_t size = 0; size < out.size(); ++size) {
    EXPECT_EQ(parse_frame(view(out).first(size), 100).status, FrameParse::Status::incomplete);
  }
  const FrameParse whole = parse_frame(view(out), 100);
  ASSERT_EQ(whole.status, FrameParse::Status::frame);
  EXPECT_EQ(whole.consumed, out.size());
  EXPECT_EQ(as_text(whole.frame.body), "body");
}

TEST(Frame, OfSizeZeroOrTooLargeIsMalformedBeforeItsBodyHasArrived) {
  const Bytes none{0, 0, 0, 0};
  const Bytes large{0, 0, 0, 101};
  const Bytes largest{0, 0, 0, 100};
  EXPECT_EQ(parse_frame(view(none), 100).status, FrameParse::Status::malformed);
  EXPECT_EQ(parse_frame(view(large), 100).status, FrameParse::Status::malformed);
  EXPECT_EQ(parse_frame(view(largest), 100).status, FrameParse::Status::incomplete);
}

TEST(FieldReader, SaysWhetherAllFieldsWereThereAndNothingIsLeft) {
  const Bytes body{1, 2, 3};
  FieldReader exact(view(body));
  exact.u8();
  EXPECT_FALSE(exact.complete());
  exact.u16();
  EXPECT_TRUE(exact.complete());
  FieldReader too_short(view(body));
  EXPECT_EQ(too_short.u32(), 0u);
  EXPECT_FALSE(too_short.complete());
}

TEST(FieldReader, RefusesATextLongerThanTheBody) {
  const Bytes body{0, 4, 'a', 'b', 'c'};
  FieldReader reader(view(body));
  EXPECT_EQ(reader.text(), "");
  EXPECT_FALSE(reader.complete());
}

TEST(StreamBuffer, KeepsWhatIsNotUsedWhileItGrows) {
  StreamBuffer buffer;
  for (std::uint8_t round = 0; round < 100; ++round) {
    std::uint8_t* space = buffer.space(3);
    space[0] = space[1] = space[2] = round;
    buffer.added(3);
    if (round > 0) {
      ASSERT_EQ(buffer.view()[0], round - 1);
      buffer.used(3);
    }
    ASSERT_EQ(buffer.view()[0], round);
  }
  EXPECT_EQ(buffer.view().size, 3u);
}

}  // namespace
}  // namespace limb_ring::client
