#include "limb_ring/payload/fragment.h"

#include <gmock/gmock.h>

#include "client/hostile_bytes.h"
#include "limb_ring/payload/announcement.h"
#include "limb_ring/payload/fragmenter.h"

namespace limb_ring::payload {
namespace {

TEST(Checksum, IsFnv1aOf32Bits) {
  // Test vectors of the FNV authors' reference code.
  const Bytes foobar{'f', 'o', 'o', 'b', 'a', 'r'};
  EXPECT_EQ(fnv1a({}), 0x811C9DC5U);
  EXPECT_EQ(fnv1a(view(foobar)), 0xBF9CF968U);
}

TEST(FragmentFormat, HasTheseBytes) {
  const Bytes text{'f', 'o', 'o', 'b', 'a', 'r'};
  Fragmenter fragmenter(5);
  ASSERT_TRUE(fragmenter.start(Fragment::Kind::data, text));
  EXPECT_THAT(fragmenter.next(), testing::ElementsAreArray(Bytes{16,   1,    5,    1,     // type, version, topic, data
                                                                 0,    0,    0,    0,     // message number
                                                                 0,    0,    0,    1,     // index, count
                                                                 0,    0,    0,    6,     // total
                                                                 0xBF, 0x9C, 0xF9, 0x68,  // checksum
                                                                 'f',  'o',  'o',  'b',  'a', 'r'}));
  EXPECT_TRUE(fragmenter.done());
}

TEST(Fragmenter, FillsEveryPacketButTheLast) {
  Fragmenter fragmenter(0);
  ASSERT_TRUE(fragmenter.start(Fragment::Kind::data, Bytes(70000)));
  std::vector<std::size_t> sizes;
  while (!fragmenter.done()) sizes.push_back(fragmenter.next().size());
  ASSERT_EQ(sizes.size(), 143U);
  EXPECT_THAT(std::vector<std::size_t>(sizes.begin(), sizes.end() - 1), testing::Each(512U));
  EXPECT_EQ(sizes.back(), 70000 - 142 * kFragmentBytes + kFragmentHeader);
}

TEST(Fragmenter, SendsAnEmptyMessageAsOnePacket) {
  Fragmenter fragmenter(0);
  EXPECT_TRUE(fragmenter.done());
  ASSERT_TRUE(fragmenter.start(Fragment::Kind::data, {}));
  EXPECT_EQ(fragmenter.next().size(), kFragmentHeader);
  EXPECT_TRUE(fragmenter.done());
}

TEST(Fragmenter, RefusesWhatNeedsMorePacketsThanCanBeCounted) {
  Fragmenter fragmenter(0);
  EXPECT_FALSE(fragmenter.start(Fragment::Kind::data, Bytes(kMaxMessage + 1)));
  EXPECT_TRUE(fragmenter.done());
  EXPECT_TRUE(fragmenter.start(Fragment::Kind::data, Bytes(kMaxMessage)));
}

TEST(FragmentFormat, RefusesFieldsThatContradictEachOther) {
  Fragmenter fragmenter(0);
  ASSERT_TRUE(fragmenter.start(Fragment::Kind::data, Bytes(1000)));
  const Bytes good = fragmenter.next();
  const auto error_with = [&](std::size_t at, std::uint8_t value) {
    Bytes bytes = good;
    bytes[at] = value;
    return decode_fragment(view(bytes)).error();
  };
  ASSERT_TRUE(decode_fragment(view(good)));
  EXPECT_EQ(error_with(3, 2), DecodeError::bad_field);       // kind
  EXPECT_EQ(error_with(9, 3), DecodeError::bad_field);       // index 3 of 3
  EXPECT_EQ(error_with(11, 4), DecodeError::bad_count);      // 4 pieces for 1000 bytes
  EXPECT_EQ(error_with(12, 0xFF), DecodeError::bad_field);   // 4 GB
  EXPECT_EQ(error_with(9, 2), DecodeError::trailing_bytes);  // the last piece is short
}

TEST(FragmentFormat, SurvivesTruncationAndRandomBytes) {
  const auto decode = [](ByteView bytes) { return decode_fragment(bytes); };
  Fragmenter fragmenter(9);
  ASSERT_TRUE(fragmenter.start(Fragment::Kind::data, Bytes(700)));
  expect_every_truncation_is_refused(fragmenter.next(), decode);
  std::mt19937 random(4711);
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes(random() % 64);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random() % 4 == 0 ? random() : 0);
    if (bytes.size() > 1) bytes[0] = 16, bytes[1] = 1;
    const auto fragment = decode_fragment(view(bytes));
    if (fragment) {
      ASSERT_EQ(encode(*fragment), bytes);
    }
  }
}

TEST(AnnouncementFormat, HasTheseBytesAndReadsBack) {
  const Announcement announcement{"a", "b/C", "5", "x", true};
  const auto bytes = encode(announcement);
  ASSERT_TRUE(bytes);
  EXPECT_THAT(*bytes, testing::ElementsAreArray(Bytes{1, 1,                 // version, latching
                                                      0, 1, 'a',            //
                                                      0, 3, 'b', '/', 'C',  //
                                                      0, 1, '5',            //
                                                      0, 0, 0, 1, 'x'}));
  EXPECT_TRUE(*decode_announcement(view(*bytes)) == announcement);
  expect_every_truncation_is_refused(*bytes, decode_announcement);
}

TEST(AnnouncementFormat, RefusesAnEmptyTypeAndAWildcard) {
  for (const Announcement& announcement : {Announcement{"a", "", "md5", "x"}, Announcement{"a", "*", "md5", "x"},
                                           Announcement{"a", "b/C", "", "x"}, Announcement{"a", "b/C", "*", "x"}}) {
    const auto decoded = decode_announcement(view(*encode(announcement)));
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error(), DecodeError::bad_field);
  }
}

TEST(AnnouncementFormat, RefusesATextLongerThanItsLengthField) {
  Announcement announcement;
  announcement.datatype.assign(65536, 'x');
  const auto bytes = encode(announcement);
  ASSERT_FALSE(bytes);
  EXPECT_EQ(to_string(bytes.error()), "item 1: is longer than the format allows");
}

}  // namespace
}  // namespace limb_ring::payload
