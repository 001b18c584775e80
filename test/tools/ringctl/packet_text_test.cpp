// The lines of `ringctl traffic show`.
#include "tools/common/packet_text.h"
#include "tools/ringctl/live_dump.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/node_literal.h"
#include "wire/control_message.h"
#include "wire/packets.h"

namespace limb_ring::ringctl {
namespace {

using app::event_json;
using app::packet_json;
using app::PacketText;
using app::PacketTextOptions;
using app::Stamps;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const capture::RingNames kNames{"robot", {{0_id, "body"}, {1_id, "hip"}, {2_id, "knee"}}};

CapturedPacket captured(test::Bytes bytes, std::int64_t time_ns = 0) {
  CapturedPacket packet;
  packet.time_ns = time_ns;
  packet.info.from = 1;
  packet.info.to = 2;
  packet.bytes = std::move(bytes);
  return packet;
}

std::string line_of(const CapturedPacket& packet, PacketTextOptions options = {}) {
  return PacketText(kNames, options).line(packet);
}

TEST(PacketLine, ShowsAllFieldsOfADataPacket) {
  EXPECT_EQ(line_of(captured(test::data_packet(0, 2, 3, wire::pri_byte(wire::Priority{1}, wire::ChannelId{0}),
                                               {false, 2, wire::Sequence{5}, {}}),
                             1'500'000'042)),
            "(001.500000042)  hip -> knee   DATP  body -> knee  hop   0  fbc 255  p1 user     2/5  [  3]  00 01 02");
}

TEST(PacketLine, ShowsBytesAsCharactersTooIfAsked) {
  CapturedPacket packet = captured(test::data_packet(0, 2, 3, wire::pri_byte(wire::Priority{1}, wire::ChannelId{0}),
                                                     {false, 2, wire::Sequence{5}, {}}));
  PacketTextOptions options;
  options.ascii = true;
  EXPECT_THAT(line_of(packet, options), EndsWith("00 01 02  '...'"));
}

TEST(PacketLine, ShowsAllFieldsOfAnInterruptAndWhereItWas) {
  CapturedPacket packet = captured(test::interrupt_packet(2, wire::kBroadcast, 6));
  packet.info.embedded = true;
  packet.info.carrier_source = 1;
  packet.info.carrier_offset = 128;
  EXPECT_THAT(line_of(packet), HasSubstr("INTP  knee -> all   hop   0  fbc 255  INT6        0/0  [  0]"));
  EXPECT_THAT(line_of(packet), EndsWith("in DATP of hip at 128"));
}

TEST(PacketLine, ShowsOnlyWhatIsKnownOfATruncatedPacket) {
  const test::Bytes whole = test::data_packet(7, 2, 8);
  CapturedPacket packet = captured({whole.begin(), whole.begin() + 6});
  packet.info.aborted = true;
  packet.lost_before = 12;
  const std::string line = line_of(packet);
  EXPECT_THAT(line, HasSubstr("7    -> ?   "));
  EXPECT_THAT(line, HasSubstr("fbc   ?"));
  EXPECT_THAT(line, EndsWith("aborted  (12 lost before)"));
}

TEST(PacketLine, CountsTimeAsCandumpDoes) {
  const auto stamps = [](Stamps how) {
    PacketTextOptions options;
    options.stamps = how;
    PacketText text(kNames, options);
    std::string all;
    for (const std::int64_t time : {1'000'000'000, 1'000'000'500, 1'000'002'000})
      all += text.line(captured(test::data_packet(0, 1), time)).substr(0, 15) + " ";
    return all;
  };
  EXPECT_EQ(stamps(Stamps::absolute), "(001.000000000) (001.000000500) (001.000002000) ");
  EXPECT_EQ(stamps(Stamps::delta), "(000.000000000) (000.000000500) (000.000001500) ");
  EXPECT_EQ(stamps(Stamps::zero), "(000.000000000) (000.000000500) (000.000002000) ");
}

TEST(PacketLine, DescribesABeaconOnlyIfAsked) {
  wire::Beacon beacon;
  beacon.boot = 77;
  beacon.cpu_state = wire::CpuState::silent;
  beacon.cpu_silent_ms = 640;
  beacon.input = wire::LinkState::up;
  beacon.input_from = 0_id;
  beacon.break_known = true;
  beacon.break_before = 1_id;
  beacon.break_behind = 2_id;
  test::Bytes data(wire::kBeaconSize);
  encode(beacon, data.data());
  test::DataPacket packet;
  packet.pri = wire::pri_byte(wire::Priority{0}, wire::ChannelId{1});
  packet.destination = wire::kBroadcast;
  packet.data = test::view(data);
  const test::Bytes bytes = test::encoded(packet);
  PacketTextOptions options;
  EXPECT_THAT(line_of(captured(bytes), options), Not(HasSubstr("beacon")));
  options.decode = true;
  EXPECT_THAT(line_of(captured(bytes), options),
              EndsWith("beacon, boot 77, CPU silent (boot 0, silent 640 ms), input up from body, output down, "
                       "break hip -> knee"));
}

TEST(PacketLine, IsColouredOnlyIfAsked) {
  PacketTextOptions options;
  const CapturedPacket packet = captured(test::interrupt_packet(0, 1, 1));
  EXPECT_THAT(line_of(packet, options), Not(HasSubstr("\033")));
  options.colour = true;
  EXPECT_THAT(line_of(packet, options), EndsWith("\033[0m"));
}

TEST(PacketLine, OfAnEventNamesTheNode) {
  PacketText text(kNames, {});
  EXPECT_EQ(text.line(capture::CapturedEvent{5, 2_id, "up -> open_chain"}),
            "(000.000000005)  * knee: up -> open_chain");
}

TEST(PacketJson, HoldsTheFields) {
  const auto row = nlohmann::json::parse(packet_json(captured(test::data_packet(0, 2, 2)), kNames));
  EXPECT_EQ(row["source"], "body");
  EXPECT_EQ(row["did"], 2);
  EXPECT_EQ(row["data"], "00 01");
  EXPECT_EQ(row["line"], (nlohmann::json{"hip", "knee"}));
}

TEST(DumpSummary, NamesOnlyWhatWasLeftOut) {
  DumpTotals totals;
  totals.shown = totals.nodes.seen = 2;
  EXPECT_EQ(summary(totals), "2 packets shown of 2 seen, 0 lost");
  totals.nodes.seen = 9;
  totals.nodes.filtered = 4;
  totals.beyond = 3;
  EXPECT_EQ(summary(totals), "2 packets shown of 9 seen, 0 lost; left out: 4 by the filter, 3 after the last");
  totals.nodes.lost = 1;
  EXPECT_EQ(summary(totals),
            "2 packets shown of 9 seen, 1 lost, read too slowly; left out: 4 by the filter, 3 after the last");
}

}  // namespace
}  // namespace limb_ring::ringctl
