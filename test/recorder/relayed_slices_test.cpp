// Slices that a node takes in and passes on: recorded by what differs, and read again as they were; refused where they
// are not what a recorder would write.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "recorder/record_format.h"
#include "recorder/record_reader.h"
#include "recorder/record_writer.h"
#include "recorder/slices_taken_in.h"

namespace limb_ring::recorder {
namespace {

using core::Line;
namespace input = core::input;
constexpr core::Time kThen{std::chrono::seconds(1)};

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint32_t kSliceSize = 400;

/// A node that takes slices in and gives slices out, and what is read of that.
class Relayed : public testing::Test {
 protected:
  void take_in(const Bytes& bytes, wire::SliceKind kind = wire::SliceKind::whole) {
    writer_.put(kThen, core::Input{input::Receive{Line::first, {kind, view(bytes)}}});
  }
  /// @return bytes that the record took
  std::size_t give_out(const std::vector<Bytes>& slices) {
    wire::SliceWriter framed;
    for (const Bytes& bytes : slices) framed.put(wire::SliceKind::whole, view(bytes));
    const std::size_t before = writer_.size();
    writer_.put(kThen, Written{Line::second, framed.view()});
    given_out_.emplace_back(framed.view().begin(), framed.view().end());
    return writer_.size() - before;
  }
  /// Of all that was given out.
  std::vector<Bytes> read_again() {
    std::vector<Bytes> result;
    RecordReader reader({room_.data(), writer_.size()}, kThen);
    while (!reader.complete()) {
      const auto record = reader.next();
      EXPECT_TRUE(record);
      if (!record) break;
      const auto* written = std::get_if<Written>(&record->what);
      if (written == nullptr) continue;
      EXPECT_EQ(written->line, Line::second);
      result.emplace_back(written->slices.begin(), written->slices.end());
    }
    return result;
  }
  static wire::ByteView view(const Bytes& bytes) { return {bytes.data(), bytes.size()}; }

  Bytes room_ = Bytes(1u << 16);
  RecordWriter writer_{core::StateWriter(room_.data(), room_.size()), kThen};
  std::vector<Bytes> given_out_;
};

/// A slice like that, passed on: another HOP and another CRC.
Bytes passed_on(Bytes slice) {
  slice[2] ^= 1;
  for (std::size_t i = 1; i <= 4; ++i) slice[slice.size() - i] ^= 0x55;
  return slice;
}

TEST_F(Relayed, isRecordedByWhatDiffers) {
  const Bytes first(kSliceSize, 1), second(kSliceSize, 2);
  take_in(first);
  take_in(second);
  EXPECT_LT(give_out({passed_on(first), passed_on(second)}), 80u);
  EXPECT_EQ(read_again(), given_out_);
}

TEST_F(Relayed, mayHaveOwnPacketsBetweenAndOthersTakenOff) {
  const Bytes first(kSliceSize, 1), home(kSliceSize, 2), third(kSliceSize, 3), own(kSliceSize, 9);
  for (const Bytes& slice : {first, home, third}) take_in(slice);
  const std::size_t size = give_out({own, passed_on(first), own, passed_on(third)});
  EXPECT_GT(size, 2 * kSliceSize);
  EXPECT_LT(size, 2 * kSliceSize + 120);
  EXPECT_EQ(read_again(), given_out_);
}

TEST_F(Relayed, mayDifferInAnyByteWithoutBeingTakenForAnother) {
  Bytes slice(kSliceSize, 1);
  for (std::size_t differing = 0; differing < 20; ++differing) {
    take_in(Bytes(kSliceSize, 1));
    give_out({slice});
    slice[differing * 20] ^= 0xFF;
  }
  EXPECT_EQ(read_again(), given_out_);
}

TEST_F(Relayed, mayBeMoreThanIsRemembered) {
  std::vector<Bytes> slices;
  for (std::uint8_t i = 0; i < 50; ++i) slices.emplace_back(kSliceSize, i);
  for (const Bytes& slice : slices) take_in(slice);
  EXPECT_LT(give_out(slices), 30 * kSliceSize);
  EXPECT_EQ(read_again(), given_out_);
}

TEST_F(Relayed, mayBeOfAnotherKindOrSize) {
  take_in(Bytes(kSliceSize, 1), wire::SliceKind::start);
  take_in(Bytes(kSliceSize + 4, 1));
  EXPECT_GT(give_out({Bytes(kSliceSize, 1)}), kSliceSize);
  EXPECT_EQ(read_again(), given_out_);
}

TEST_F(Relayed, mayHaveNoBytesAtAll) {
  take_in({}, wire::SliceKind::abort);
  wire::SliceWriter framed;
  framed.put(wire::SliceKind::abort, {});
  writer_.put(kThen, Written{Line::second, framed.view()});
  given_out_.emplace_back(framed.view().begin(), framed.view().end());
  EXPECT_EQ(read_again(), given_out_);
}

TEST_F(Relayed, ofNothingIsNothing) {
  give_out({});
  EXPECT_EQ(read_again(), given_out_);
}

TEST_F(Relayed, thatIsTooShortToBeComparedIsRecordedWhole) {
  const std::size_t least = 2 * Differences::kEnd;
  take_in(Bytes(least - 1, 1));
  EXPECT_GT(give_out({passed_on(Bytes(least - 1, 1))}), least);
  take_in(Bytes(least, 1));
  EXPECT_LT(give_out({passed_on(Bytes(least, 1))}), least);
  EXPECT_EQ(read_again(), given_out_);
}

// A slice that was passed on, as RecordWriter writes it; then one number of it is another.
struct Number {
  std::uint32_t all = kSliceSize + wire::kSliceHeaderSize, back = kSliceSize;
  std::uint16_t size = kSliceSize;
  std::uint8_t differing = 1u << (Differences::kWords - 1);
};

class Forged : public testing::Test {
 protected:
  std::optional<Record> read(Number number) {
    Bytes room(1024);
    RecordWriter writer(core::StateWriter(room.data(), room.size()), kThen);
    const Bytes taken_in(kSliceSize, 1);
    writer.put(kThen,
               core::Input{input::Receive{Line::first, {wire::SliceKind::whole, {taken_in.data(), kSliceSize}}}});
    const std::size_t before = writer.size();
    core::StateWriter rest(room.data() + before, room.size() - before);
    std::uint8_t tag = kWrittenTag | kSameTime;
    std::uint64_t word = 0x0707070707070707;
    Line line = Line::first;
    wire::SliceKind kind = wire::SliceKind::whole;
    rest("tag", tag)("line", line)("size", number.all)("kind", kind)("back", number.back)("size", number.size);
    rest("differing", number.differing)("word", word);
    reader_ = RecordReader({room.data(), before + rest.size()}, kThen);
    EXPECT_TRUE(reader_.next());
    auto record = reader_.next();
    if (record) {
      const wire::ByteView slices = std::get<Written>(record->what).slices;
      read_.assign(slices.begin(), slices.end());
    }
    return record;
  }
  /// As read(), with another number at that place.
  template <class T>
  bool is_read(T Number::*which, T other) {
    Number number;
    number.*which = other;
    return read(number).has_value();
  }
  RecordReader reader_{{}, kThen};
  Bytes read_;
};

TEST_F(Forged, soundOnesAreRead) {
  ASSERT_TRUE(read({}));
  Bytes expected(kSliceSize, 1);
  std::fill(expected.end() - Differences::kWord, expected.end(), std::uint8_t{7});
  EXPECT_EQ(Bytes(read_.begin() + wire::kSliceHeaderSize, read_.end()), expected);
}
TEST_F(Forged, noneReachesBehindItsRecord) { EXPECT_FALSE(is_read(&Number::back, kSliceSize - 1)); }
TEST_F(Forged, noneReachesBeforeTheFirstRecord) { EXPECT_FALSE(is_read(&Number::back, 2 * kSliceSize)); }
TEST_F(Forged, noneDiffersInAWordThatThereIsNot) {
  EXPECT_FALSE(is_read(&Number::differing, std::uint8_t{1u << Differences::kWords | 1u}));
}
TEST_F(Forged, noneIsShorterThanItsEnds) {
  Number number;
  number.size = 2 * Differences::kEnd - 1;
  number.all = number.size + wire::kSliceHeaderSize;
  EXPECT_FALSE(read(number));
}
TEST_F(Forged, noneIsLongerThanAnySlice) {
  Number number;
  number.back = number.size = 0xFFFF;
  number.all = number.size + wire::kSliceHeaderSize;
  EXPECT_FALSE(read(number));
}
TEST_F(Forged, noneIsOfAnotherSizeInAll) {
  for (const std::uint32_t all : {Number{}.all - 1, Number{}.all + 1, 0xFFFFFFFFu})
    EXPECT_FALSE(is_read(&Number::all, all)) << all;
}
TEST_F(Forged, noneLacksAWordThatDiffers) { EXPECT_FALSE(is_read(&Number::differing, std::uint8_t{0xF})); }

}  // namespace
}  // namespace limb_ring::recorder
