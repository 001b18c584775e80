#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "ros/small_robot.h"
#include "ros_bridge/frames_out.h"
#include "support/node_literal.h"
#include "support/packets.h"

namespace limb_ring::bridge {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using XmlRpc::XmlRpcValue;

CapturedPacket seen(std::vector<std::uint8_t> bytes) {
  CapturedPacket packet;
  packet.time_ns = 1500000000000000001;
  packet.info.from = 0;
  packet.info.to = 7;
  packet.bytes = std::move(bytes);
  return packet;
}

std::vector<std::uint8_t> data_packet(wire::Channel channel) {
  const std::uint8_t data[]{10, 20, 30};
  test::DataPacket packet;
  packet.code = {false, 1, wire::Sequence{5}, {}};
  packet.hop = 2;
  packet.source = 3_id;
  packet.fbc = 9;
  packet.destination = 7_id;
  packet.pri = wire::pri_byte(wire::Priority{1}, wire::id_of(channel));
  packet.data = {data, sizeof data};
  return encoded(packet);
}

class Frames : public ::testing::Test {
 protected:
  Frame of(const CapturedPacket& packet) const { return to_frame(packet, ring.nodes.at(1), ring); }
  std::string refusal(const XmlRpcValue& parameters) const {
    try {
      read_frame_filter(parameters, ring, ring.nodes.front());
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "not refused";
  }
  const config::RingConfig ring = small_robot();
};

TEST_F(Frames, HaveTheFieldsOfAWholePacket) {
  const Frame frame = of(seen(data_packet(wire::Channel::joint)));
  EXPECT_EQ(frame.header.stamp, ros::Time(1500000000, 1));
  EXPECT_EQ(frame.node, "knee");
  EXPECT_EQ(frame.line_from, "body");
  EXPECT_EQ(frame.line_to, "knee");
  EXPECT_EQ(frame.kind, Frame::DATA);
  EXPECT_EQ(frame.attempt, 1);
  EXPECT_EQ(frame.sequence, 5);
  EXPECT_EQ(frame.hop, 2);
  EXPECT_EQ(frame.sid, 3);
  EXPECT_EQ(frame.fbc, 9);
  EXPECT_EQ(frame.did, 7);
  EXPECT_EQ(frame.priority, 1);
  EXPECT_EQ(frame.channel, 2);
  EXPECT_TRUE(frame.whole);
  EXPECT_TRUE(frame.crc_ok);
  EXPECT_EQ(frame.size, 15);
  EXPECT_THAT(frame.payload, ElementsAre(10, 20, 30));
}

TEST_F(Frames, OfChannelOneAreControl) {
  EXPECT_EQ(of(seen(data_packet(wire::Channel::control))).kind, Frame::CONTROL);
}

TEST_F(Frames, OfABadCrcSaySo) {
  auto packet = seen(data_packet(wire::Channel::user));
  packet.info.crc_bad = true;
  EXPECT_FALSE(of(packet).crc_ok);
  EXPECT_TRUE(of(packet).whole);
}

TEST_F(Frames, OfABrokenOffPacketHoldWhatHasCome) {
  auto packet = seen(data_packet(wire::Channel::joint));
  packet.bytes.resize(6);
  packet.info.aborted = true;
  const Frame frame = of(packet);
  EXPECT_FALSE(frame.whole);
  EXPECT_FALSE(frame.crc_ok);
  EXPECT_EQ(frame.sid, 3);
  EXPECT_EQ(frame.did, 0);
  EXPECT_THAT(frame.payload, ElementsAre(10, 20));
}

TEST_F(Frames, AreThoseOfTheOwnInputIfNothingIsChosen) {
  const auto filter = read_frame_filter(XmlRpcValue(), ring, ring.nodes.at(2));
  ASSERT_EQ(filter.nodes.size(), 1u);
  EXPECT_EQ(filter.nodes.front()->name, "hip");
  const json packets = json::parse(filter.order)["packets"];
  EXPECT_FALSE(packets.contains("at"));
  EXPECT_EQ(packets["limit_per_s"], 1000);
}

TEST_F(Frames, AreChosenByParameters) {
  XmlRpcValue parameters;
  parameters["nodes"] = "all";
  parameters["kinds"][0] = "data";
  parameters["kinds"][1] = "interrupt";
  parameters["source"][0] = "knee";
  parameters["source"][1] = 3;
  parameters["destination"] = "all";
  parameters["priority"] = 0;
  parameters["sample"] = 10;
  const auto filter = read_frame_filter(parameters, ring, ring.nodes.front());
  EXPECT_EQ(filter.nodes.size(), 3u);
  const json packets = json::parse(filter.order)["packets"];
  EXPECT_EQ(packets["kinds"], (json{"data", "interrupt"}));
  EXPECT_EQ(packets["source"], (json{7, 3}));
  EXPECT_EQ(packets["destination"], (json{"all"}));
  EXPECT_EQ(packets["priority"], (json{0}));
  EXPECT_EQ(packets["sample"], 10);
}

TEST_F(Frames, AreRefusedForWrongParametersWithWhatWouldBeRight) {
  XmlRpcValue wrong;
  wrong["nodes"] = "tail";
  EXPECT_THAT(refusal(wrong), HasSubstr("~frames/nodes: tail; it must be of: all, body, knee, hip"));
  wrong = XmlRpcValue();
  wrong["nodes"][0] = "knee";
  wrong["nodes"][1] = 7;
  EXPECT_THAT(refusal(wrong), HasSubstr("~frames/nodes: node 'knee' is named twice"));
  wrong["nodes"][0] = "all";
  EXPECT_THAT(refusal(wrong), HasSubstr("node 'knee' is named twice"));
  wrong = XmlRpcValue();
  wrong["kinds"] = "beacon";
  EXPECT_THAT(refusal(wrong), HasSubstr("data, control, interrupt"));
  wrong = XmlRpcValue();
  wrong["priority"] = 4;
  EXPECT_THAT(refusal(wrong), HasSubstr("~frames/priority: 4; it must be 0 to 3"));
  wrong = XmlRpcValue();
  wrong["sample"] = 0;
  EXPECT_THAT(refusal(wrong), HasSubstr("1 to 1000000"));
  wrong = XmlRpcValue();
  wrong["colour"] = "red";
  EXPECT_THAT(refusal(wrong), HasSubstr("parameter ~frames/colour does not exist"));
  EXPECT_THAT(refusal(XmlRpcValue(7)), HasSubstr("must be a map"));
}

}  // namespace
}  // namespace limb_ring::bridge
