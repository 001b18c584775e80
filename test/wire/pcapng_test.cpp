#include <gmock/gmock.h>

#include <sstream>

#include "support/node_literal.h"
#include "support/thrown.h"
#include "wire/packets.h"
#include "wire/pcapng.h"

namespace limb_ring::capture {
namespace {

using test::Bytes;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const RingNames kNames{"robot", {{1_id, "hip"}, {2_id, "knee"}, {3_id, "foot"}}};
const Bytes kPacket = test::data_packet(1, 3, 5);  // 17 bytes: padding is needed

CaptureInfo some_info() {
  CaptureInfo info;
  info.input = true;
  info.from = 1;
  info.to = 2;
  info.crc_bad = info.embedded = info.own = true;
  info.span = std::chrono::nanoseconds(4192);
  info.carrier_source = 3;
  info.carrier_code = 0x45;
  info.carrier_offset = 516;
  return info;
}

std::vector<PcapngReader::Record> read_all(const std::string& file) {
  std::istringstream in(file);
  PcapngReader reader(in, "file");
  std::vector<PcapngReader::Record> records;
  while (auto record = reader.next()) records.push_back(*record);
  return records;
}

std::string file_of_one_packet() {
  std::ostringstream out;
  PcapngWriter(out, kNames).packet(1'763'757'352'123'456'789, some_info(), test::view(kPacket), 42);
  return out.str();
}

std::string problem_with(const std::string& file) {
  return test::thrown<CaptureFileError>([&] { read_all(file); });
}

TEST(Pcapng, PacketsComeBackAsTheyWereWritten) {
  const auto records = read_all(file_of_one_packet());
  ASSERT_EQ(records.size(), 1u);
  const auto& packet = std::get<CapturedPacket>(records[0]);
  EXPECT_EQ(packet.time_ns, 1'763'757'352'123'456'789);
  EXPECT_EQ(packet.lost_before, 42u);
  EXPECT_EQ(packet.bytes, kPacket);
  const CaptureInfo info = some_info();
  EXPECT_EQ(packet.info.input, info.input);
  EXPECT_EQ(packet.info.from, info.from);
  EXPECT_EQ(packet.info.to, info.to);
  EXPECT_TRUE(packet.info.crc_bad && packet.info.embedded && packet.info.own);
  EXPECT_FALSE(packet.info.aborted || packet.info.truncated || packet.info.retry);
  EXPECT_EQ(packet.info.span, info.span);
  EXPECT_EQ(packet.info.carrier_source, info.carrier_source);
  EXPECT_EQ(packet.info.carrier_code, info.carrier_code);
  EXPECT_EQ(packet.info.carrier_offset, info.carrier_offset);
}

TEST(Pcapng, EventsAndNamesComeBack) {
  std::ostringstream out;
  PcapngWriter writer(out, kNames);
  writer.event(7, 2_id, "up -> open_chain");
  std::istringstream in(out.str());
  PcapngReader reader(in, "file");
  const auto event = std::get<CapturedEvent>(reader.next().value());
  EXPECT_EQ(event.time_ns, 7);
  EXPECT_EQ(event.node, 2);
  EXPECT_EQ(event.what, "up -> open_chain");
  EXPECT_EQ(reader.names().ring, "robot");
  EXPECT_EQ(reader.names().nodes, kNames.nodes);
  EXPECT_EQ(reader.names().line(3, 9), "foot -> 9");
}

TEST(Pcapng, EveryLineIsAnInterfaceOnce) {
  std::ostringstream out;
  PcapngWriter writer(out, kNames);
  CaptureInfo info;
  for (const auto& [from, to] : {std::pair{1, 2}, std::pair{2, 3}, std::pair{1, 2}}) {
    info.from = static_cast<wire::NodeId>(from);
    info.to = static_cast<wire::NodeId>(to);
    writer.packet(0, info, test::view(kPacket));
  }
  const std::string file = out.str();
  EXPECT_THAT(file, HasSubstr("knee -> foot"));
  EXPECT_EQ(file.find("hip -> knee"), file.rfind("hip -> knee"));
  EXPECT_EQ(read_all(file).size(), 3u);
}

TEST(Pcapng, AFileThatWasCutShortIsReadAsFarAsItGoes) {
  const std::string one = file_of_one_packet();
  std::istringstream in(one + one.substr(0, 20));
  PcapngReader reader(in, "file");
  EXPECT_TRUE(reader.next().has_value());
  EXPECT_FALSE(reader.next().has_value());
  EXPECT_TRUE(reader.cut_short());
}

/// What the reader has to say of a packet of such bytes, written with such flags.
std::vector<std::string> problems_of(const Bytes& bytes, const CaptureInfo& info, bool crc_bad) {
  std::ostringstream out;
  PcapngWriter(out, kNames).packet(0, info, test::view(bytes));
  std::istringstream in(out.str());
  PcapngReader reader(in, "file");
  EXPECT_EQ(std::get<CapturedPacket>(reader.next().value()).info.crc_bad, crc_bad);
  return reader.problems();
}

TEST(Pcapng, APacketThatWasChangedInTheFileIsReportedAsBroken) {
  CaptureInfo good, bad, aborted;
  bad.crc_bad = true;
  aborted.aborted = true;
  for (const Bytes& packet : {kPacket, test::interrupt_packet(1, 3, 6)}) {
    Bytes changed = packet;
    changed[3] ^= 1;
    const auto is_told = ElementsAre("file: 1 packet is not as it was captured");
    EXPECT_THAT(problems_of(changed, good, true), is_told);
    EXPECT_THAT(problems_of({packet.begin(), packet.begin() + 7}, good, true), is_told) << "cut by a tool";
    EXPECT_THAT(problems_of(packet, bad, true), is_told) << "its flags were changed";
    EXPECT_THAT(problems_of(packet, good, false), IsEmpty());
    EXPECT_THAT(problems_of(changed, bad, true), IsEmpty()) << "it came in like that";
    EXPECT_THAT(problems_of(changed, aborted, false), IsEmpty());
  }
}

TEST(Pcapng, APacketThatIsLongerThanAnyOnALineIsRefused) {
  for (const std::size_t size : {525u, 65544u}) {  // of the second 16 bits say 8: shorter than a packet
    std::ostringstream out;
    PcapngWriter(out, kNames).packet(0, {}, test::view(Bytes(size, 0)));
    EXPECT_THAT(problem_with(out.str()), HasSubstr("a packet of " + std::to_string(size) + " bytes; 524 at most"));
  }
}

TEST(Pcapng, AnotherFileIsRefusedWithItsName) {
  EXPECT_THAT(problem_with("no capture at all"), StartsWith("file: at byte 0: no pcapng file"));
  EXPECT_THAT(problem_with(""), HasSubstr("no pcapng file"));
}

// ---- what others have written ---------------------------------------------------------------

std::string u32(std::uint32_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i));
  return bytes;
}

std::string block(std::uint32_t type, const std::string& body) {
  const auto size = static_cast<std::uint32_t>(body.size() + 12);
  return u32(type) + u32(size) + body + u32(size);
}

/// A section of one interface, of that link type and time resolution, and so many packets of 20 bytes.
std::string foreign(unsigned packets, std::uint32_t link_type = 1, char resolution = 6) {
  std::string file =
      block(0x0A0D0D0A, u32(0x1A2B3C4D) + u32(1) + std::string(8, '\xFF')) +
      block(1, u32(link_type) + u32(65535) + u32(9 | 1 << 16) + u32(static_cast<std::uint8_t>(resolution)));
  while (packets-- > 0) file += block(6, u32(0) + u32(0) + u32(1) + u32(20) + u32(20) + std::string(20, 'x'));
  return file;
}

std::vector<std::string> problems_of_file(const std::string& file, std::size_t packets) {
  std::istringstream in(file);
  PcapngReader reader(in, "file");
  for (std::size_t i = 0; i < packets; ++i) EXPECT_TRUE(reader.next());
  EXPECT_FALSE(reader.next());
  return reader.problems();
}

TEST(Pcapng, WhatIsNotOursNeedNotBeUnderstoodAndIsCounted) {
  const std::string large = block(6, u32(0) + std::string(2 << 20, 'x')),
                    secrets = block(10, std::string(2 << 20, 'x'));
  const std::string simple = block(3, u32(8) + std::string(8, 'x'));
  for (const char resolution : {6, 30, 127, -96, -1}) {
    const std::string file =
        foreign(3, 1, resolution) + large + secrets + simple + file_of_one_packet() + foreign(1, 147);
    EXPECT_THAT(problems_of_file(file, 1), Contains("file: skipped 6 of 7 packets, which are of another protocol"));
  }
}

TEST(Pcapng, AFileWithoutAnyPacketOfOursIsAnErrorThatSaysWhatItHas) {
  EXPECT_THAT(problem_with(foreign(4)), HasSubstr("file: no packet of this protocol; skipped 4 of 4"));
  EXPECT_THAT(problem_with(foreign(2, 147)), HasSubstr("skipped 2 of 2")) << "of our link type";
  EXPECT_THAT(problem_with(foreign(0)), HasSubstr("skipped 0 of 0"));
  std::ostringstream nothing;
  PcapngWriter(nothing, kNames);
  EXPECT_THAT(problems_of_file(nothing.str(), 0), IsEmpty()) << "our own of a ring that was silent";
}

TEST(Pcapng, OursIsKnownAlsoInTheSectionOfAToolThatHasMergedIt) {
  const std::string ours = file_of_one_packet();
  const std::size_t first = static_cast<std::uint8_t>(ours[4]);  // bytes of its section header
  EXPECT_EQ(read_all(foreign(0).substr(0, 28) + ours.substr(first)).size(), 1u);
}

TEST(Pcapng, OtherFormatsAreNamedWithTheToolThatConvertsThem) {
  const std::string rest(20, 'x');
  EXPECT_THAT(problem_with("\x1F\x8B" + rest), HasSubstr("compressed by gzip; 'gunzip"));
  EXPECT_THAT(problem_with("\xD4\xC3\xB2\xA1" + rest), HasSubstr("classic pcap file; 'editcap -F pcapng"));
  EXPECT_THAT(problem_with("\x4D\x3C\xB2\xA1" + rest), HasSubstr("classic pcap"));
}

TEST(Pcapng, NamesAndEventsAreFitForATerminalAndJson) {
  std::ostringstream out;
  PcapngWriter writer(out, {"robot", {{1_id, "h\xFE\x1B[2Jp"}}});
  writer.event(5, 1_id, "its \xFF name\n");
  const std::string file = out.str();
  std::istringstream in(file);
  PcapngReader reader(in, "file");
  const auto event = reader.next();
  EXPECT_EQ(reader.names().of(1), "h??[2Jp");
  EXPECT_EQ(std::get<CapturedEvent>(*event).what, "its ? name?");
}

/// The packet at a time of so many steps of 10^-resolution s.
std::string file_of_time(std::uint64_t time, char resolution) {
  std::string file = file_of_one_packet();
  const std::size_t option = file.find(std::string("\x09\0\x01\0\x09", 5)),
                    packet = file.find(std::string("\x06\0\0\0", 4), option);
  file[option + 4] = resolution;
  for (unsigned i = 0; i < 4; ++i) {
    file[packet + 12 + i] = static_cast<char>(time >> (32 + 8 * i));
    file[packet + 16 + i] = static_cast<char>(time >> (8 * i));
  }
  return file;
}

std::int64_t time_of_one(const std::string& file) { return std::get<CapturedPacket>(read_all(file).at(0)).time_ns; }

TEST(Pcapng, TimesComeInAnyPowerOfTenOrTwo) {
  EXPECT_EQ(time_of_one(file_of_time(3u << 9, static_cast<char>(0x80 | 10))), 1'500'000'000);
  EXPECT_EQ(time_of_one(file_of_time(UINT64_MAX, 127)), 0);
  EXPECT_EQ(time_of_one(file_of_time(1'763'757'352, 0)), 1'763'757'352'000'000'000);
  EXPECT_EQ(time_of_one(file_of_time(1'763'757'352'123'456, 6)), 1'763'757'352'123'456'000);
  EXPECT_EQ(time_of_one(file_of_time(1'763'757'352'123'456'789'5u, 10)), 1'763'757'352'123'456'789);
}

TEST(Pcapng, ATimeBeyondNanosecondsOf64BitsIsRefused) {
  for (const char resolution : {0, 3, 6, 9})
    EXPECT_THAT(problem_with(file_of_time(UINT64_MAX, resolution)), HasSubstr("a time after the year 2261"));
  EXPECT_THAT(problem_with(file_of_time(10'000'000'000, 0)), HasSubstr("a time after the year 2261"));
}

TEST(Pcapng, NoTruncationOrFlippedByteBreaksTheReader) {
  const std::string good = file_of_one_packet();
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0xFF);
    for (const std::string& file : {bad, good.substr(0, i)}) {
      try {
        EXPECT_LE(read_all(file).size(), 1u);
      } catch (const CaptureFileError& problem) {
        EXPECT_THAT(problem.what(), StartsWith("file: "));
      }
    }
  }
}

}  // namespace
}  // namespace limb_ring::capture
