// Records of a core's inputs: as they were written, and refused if no driver of a core would leave them.
#include <gtest/gtest.h>

#include "judge/record.h"
#include "judge/replay.h"

namespace limb_ring::recorder {
namespace {

using core::Line;
using core::Time;
namespace input = core::input;
using namespace std::chrono_literals;

constexpr Line kNoLine{7};
constexpr Time kNow{1s};

/// Written at that time, and read by who was at `last`.
template <class What>
std::optional<Record> again(const What& what, Time at = kNow, Time last = kNow) {
  static std::uint8_t room[2048];  // the record points into it
  RecordWriter writer(core::StateWriter(room, sizeof room), last);
  writer.put(at, what);
  EXPECT_FALSE(writer.failed());
  RecordReader reader({room, writer.size()}, last);
  auto record = reader.next();
  EXPECT_TRUE(!record || reader.complete());
  return record;
}

TEST(Record, isReadAsItWasWritten) {
  const auto record = again(core::Input{input::InputUp{Line::second, wire::NodeId{9}}}, kNow + 3us);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->at, kNow + 3us);
  const auto& call = std::get<input::InputUp>(std::get<core::Input>(record->what));
  EXPECT_EQ(call.line, Line::second);
  EXPECT_EQ(call.from, 9);
}

/// What a record of that input says once it is read.
std::string read_back(const core::Input& what) {
  const auto record = again(what);
  if (!record) return "none";
  TextArchive text(TextArchive::Form::one_line);
  std::visit([&](auto call) { call.archive(text); }, std::get<core::Input>(record->what));
  return text.text();
}

TEST(Record, hasAllOfEachInput) {
  const std::vector<std::uint8_t> bytes{0xAB, 0xCD, 0x01, 0x02};
  const wire::ByteView data{bytes.data(), bytes.size()};
  const core::SendRequest request{11, 12, wire::NodeId{13}, wire::Priority{2}, wire::ChannelId{5}, data};
  const core::InterruptRequest interrupt{21, 22, wire::NodeId{23}, wire::Factor{4}};
  const core::CpuReport report{31, wire::CpuState::failed, false, kNow, true, {7, wire::NodeId{8}, 9}};
  EXPECT_EQ(read_back(input::InputUp{Line::second, wire::NodeId{9}}), "line 1 from 9");
  EXPECT_EQ(read_back(input::InputLost{Line::second}), "line 1");
  EXPECT_EQ(read_back(input::InputGap{Line::second}), "line 1");
  EXPECT_EQ(read_back(input::OutputUp{Line::second, wire::NodeId{9}}), "line 1 to 9");
  EXPECT_EQ(read_back(input::OutputLost{Line::second}), "line 1");
  EXPECT_EQ(read_back(input::OutputReady{Line::second, true}), "line 1 ready 1");
  EXPECT_EQ(read_back(input::Receive{Line::second, {wire::SliceKind::more, data}}), "line 1 kind 2 bytes abcd0102");
  EXPECT_EQ(read_back(input::Send{request}), "owner 11 token 12 destination 13 priority 2 channel 5 data abcd0102");
  EXPECT_EQ(read_back(input::Interrupt{interrupt}), "owner 21 token 22 destination 23 factor 4");
  EXPECT_EQ(read_back(input::Pull{41, 42, 3}), "owner 41 token 42 input 3");
  EXPECT_EQ(read_back(input::Cancel{51}), "owner 51");
  EXPECT_EQ(read_back(input::CpuReset{61}), "cpu 61");
  EXPECT_EQ(read_back(input::Cpu{report}),
            "boots 31 state 5 comes_back 0 spoke_at 1.000000000000 s stop_latched 1 count 7 source 8 clock_ns 9");
  EXPECT_EQ(read_back(input::CpuPresent{true}), "present 1");
  EXPECT_EQ(read_back(input::Timeout{}), "");
  EXPECT_EQ(read_back(input::Run{}), "");
}

TEST(Record, ofALineThatNoRingHasIsInvalid) {
  EXPECT_FALSE(again(core::Input{input::InputUp{kNoLine, wire::NodeId{9}}}));
  EXPECT_FALSE(again(core::Input{input::OutputReady{kNoLine, true}}));
  EXPECT_FALSE(again(Written{kNoLine, {}}));
}

TEST(Record, ofASliceThatNoLineCarriesIsInvalid) {
  const std::uint8_t bytes[7] = {};
  EXPECT_FALSE(again(core::Input{input::Receive{Line::first, {wire::SliceKind::start, {bytes, sizeof bytes}}}}));
  EXPECT_FALSE(again(core::Input{input::Receive{Line::first, {wire::SliceKind{99}, {}}}}));
}

TEST(Record, ofAPacketForTheCpuHasTheCrcOfItsData) {
  core::ReceivedPacket packet;
  packet.source = wire::NodeId{3};
  packet.size = 2;
  packet.data[0] = 1, packet.data[1] = 2;
  const auto record = again(Taken(packet));
  ASSERT_TRUE(record);
  const auto& taken = std::get<Taken>(record->what);
  EXPECT_EQ(taken.source, 3);
  EXPECT_EQ(taken.size, 2u);
  EXPECT_EQ(taken.crc, wire::crc32(packet.bytes()));
}

TEST(Record, thatIsEarlierThanTheOneBeforeIsInvalid) {
  EXPECT_TRUE(again(core::Input{input::Run{}}, kNow, kNow - 1us));
  EXPECT_FALSE(again(core::Input{input::Run{}}, kNow - 1us, kNow));
}

TEST(Record, atTheTimeOfTheOneBeforeSaysSoInItsTagAlone) {
  std::uint8_t room[16];
  RecordWriter writer(core::StateWriter(room, sizeof room), kNow);
  writer.put(kNow, core::Input{input::Run{}});
  EXPECT_EQ(writer.size(), 1u);
  writer.put(kNow + 1us, core::Input{input::Run{}});
  EXPECT_GT(writer.size(), 2u);
  RecordReader reader({room, writer.size()}, kNow);
  EXPECT_EQ(reader.next()->at, kNow);
  EXPECT_EQ(reader.next()->at, kNow + 1us);
  EXPECT_TRUE(reader.complete());
}

TEST(Record, mayBeAnyTimeLater) {
  for (const auto later : {core::Duration{1}, core::Duration{1us}, core::Duration{213 * 24h}, core::Duration{214 * 24h},
                           core::Duration{20 * 365 * 24h}}) {
    const auto record = again(core::Input{input::Run{}}, kNow + later, kNow);
    ASSERT_TRUE(record) << later.count() / 1e12;
    EXPECT_EQ(record->at, kNow + later);
  }
}

TEST(Record, laterThanAnyRingLivesIsInvalid) {
  EXPECT_FALSE(again(core::Input{input::Run{}}, kNow + core::Duration{20000 * 365 * 24h}, kNow));
}

}  // namespace
}  // namespace limb_ring::recorder
