// Packets whose data the core does not look at: recorded without it, and read again with all else.
#include <gtest/gtest.h>

#include <vector>

#include "judge/record.h"
#include "support/packets.h"
#include "support/view.h"

namespace limb_ring::recorder {
namespace {

using core::Line;
using wire::SliceKind;
namespace input = core::input;
using test::view;

constexpr core::Time kThen{std::chrono::seconds(1)};
constexpr std::size_t kData = 400;

using Bytes = std::vector<std::uint8_t>;
Bytes from_0_to_2(std::size_t size = kData) {
  const Bytes data(size, 0x5A);
  test::DataPacket fields;
  fields.source = wire::NodeId{0};
  fields.destination = wire::NodeId{2};
  fields.pri = wire::pri_byte(wire::Priority{2}, id_of(wire::Channel::user));
  fields.data = view(data);
  return encoded(fields);
}

/// What a node takes in and gives out, and what is read of that.
class Abridged : public testing::Test {
 protected:
  /// @return bytes that the record took
  std::size_t take_in(const Bytes& bytes, bool only_passes, SliceKind kind = SliceKind::whole) {
    const std::size_t before = writer_.size();
    writer_.put(kThen, core::Input{input::Receive{Line::second, {kind, view(bytes)}, only_passes}});
    return writer_.size() - before;
  }
  std::size_t give_out(const std::vector<Bytes>& packets, SliceKind kind = SliceKind::whole) {
    wire::SliceWriter framed;
    for (const Bytes& bytes : packets) framed.put(kind, view(bytes));
    const std::size_t before = writer_.size();
    writer_.put_written(kThen, Line::second, framed.view());
    return writer_.size() - before;
  }
  std::optional<Record> read_next() { return reader_.next(); }
  /// The slice that was taken in next, as it is read.
  wire::Slice read_slice(bool left_out) {
    const auto record = read_next();
    EXPECT_TRUE(record);
    if (!record) return {};
    EXPECT_EQ(record->data_left_out, left_out);
    const auto& call = std::get<input::Receive>(std::get<core::Input>(record->what));
    EXPECT_EQ(call.line, Line::second);
    return call.slice;
  }

  Bytes room_ = Bytes(1u << 16);
  RecordWriter writer_{core::StateWriter(room_.data(), room_.size()), kThen};
  RecordReader reader_{{room_.data(), room_.size()}, kThen};
};

TEST_F(Abridged, isWhatOnlyPasses) {
  const Bytes passes = from_0_to_2();
  EXPECT_LT(take_in(passes, true), 30u);
  EXPECT_TRUE(writer_.left_out());
  const wire::Slice slice = read_slice(true);
  EXPECT_EQ(slice.kind, SliceKind::whole);
  Bytes expected = passes;
  std::fill_n(expected.begin() + wire::kHeaderSize, kData, std::uint8_t{0});
  EXPECT_EQ(Bytes(slice.bytes.begin(), slice.bytes.end()), expected);
}

TEST_F(Abridged, isNothingThatTheNodeTakes) {
  const Bytes bytes = from_0_to_2();
  EXPECT_GT(take_in(bytes, false), kData);
  const wire::Slice slice = read_slice(false);
  EXPECT_EQ(Bytes(slice.bytes.begin(), slice.bytes.end()), bytes);
  EXPECT_FALSE(writer_.left_out());
}

TEST_F(Abridged, isNoPartOfAPacket) {
  EXPECT_GT(take_in(Bytes(kData, 7), false, SliceKind::start), kData);
  EXPECT_GT(give_out({Bytes(kData, 7)}, SliceKind::more), kData);
}

TEST_F(Abridged, isNothingThatHardlyBecomesShorter) {
  const std::size_t least = kLeastAbridged - wire::kOverhead;
  take_in(from_0_to_2(least - 1), true);
  take_in(from_0_to_2(least), true);
  read_slice(false);
  read_slice(true);
}

TEST_F(Abridged, isAlsoWhatGoesOut) {
  EXPECT_LT(give_out({from_0_to_2(), from_0_to_2()}), 50u);
  const auto record = read_next();
  ASSERT_TRUE(record);
  const auto& written = std::get<Written>(record->what);
  EXPECT_EQ(written.line, Line::second);
  EXPECT_EQ(written.slices.size, 2 * (3 + kAbridgedSize));
}

TEST_F(Abridged, mayHaveNoBytesAtAll) {
  take_in({}, false, SliceKind::abort);
  give_out({{}}, SliceKind::abort);
  give_out({});
  read_slice(false);
  EXPECT_EQ(std::get<Written>(read_next()->what).slices.size, 3u);
  EXPECT_TRUE(std::get<Written>(read_next()->what).slices.empty());
}

/// A record of a packet without its data, as anybody may write it.
std::optional<Record> forged(SliceKind kind, std::uint32_t size, std::size_t bytes = kAbridgedSize) {
  Bytes room(64);
  core::StateWriter writer(room.data(), room.size());
  std::uint8_t tag = static_cast<std::uint8_t>(core::Input{input::Receive{}}.index()) | kSameTime;
  std::uint8_t abridged = static_cast<std::uint8_t>(kind) | kAbridged;
  Line line = Line::first;
  writer("tag", tag)("line", line)("kind", abridged)("size", size);
  RecordReader reader({room.data(), writer.size() + bytes}, kThen);
  return reader.next();
}

TEST(Forged, isReadIfItIsSound) { EXPECT_TRUE(forged(SliceKind::whole, 400)); }
TEST(Forged, ofAnotherKindIsNotRead) {
  EXPECT_FALSE(forged(SliceKind::start, 400));
  EXPECT_FALSE(forged(SliceKind::interrupt, 12));
}
TEST(Forged, ofASizeThatNoPacketHasIsNotRead) {
  for (const std::uint32_t size :
       {std::uint32_t{0}, std::uint32_t{kLeastAbridged - 1}, std::uint32_t{wire::kMaxDataPacketSize + 1}, 0xFFFFFFFFu})
    EXPECT_FALSE(forged(SliceKind::whole, size)) << size;
}
TEST(Forged, thatIsCutOffIsNotRead) { EXPECT_FALSE(forged(SliceKind::whole, 400, kAbridgedSize - 1)); }

}  // namespace
}  // namespace limb_ring::recorder
