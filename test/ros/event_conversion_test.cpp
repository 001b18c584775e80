#include "ros_bridge/events_out.h"

#include <gmock/gmock.h>

#include "ros/small_robot.h"

namespace limb_ring::bridge {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class Events : public ::testing::Test {
 protected:
  const config::RingConfig ring = small_robot();
  const config::NodeConfig &body = ring.nodes.at(0), &knee = ring.nodes.at(1), &hip = ring.nodes.at(2);
  EventConversion conversion{ring};

  RingEvent only(const config::NodeConfig& node, const std::string& line) {
    const auto all = conversion.events_of(node, line);
    EXPECT_THAT(all, SizeIs(1));
    return all.empty() ? RingEvent() : all.front();
  }
  static std::vector<int> kinds_of(const std::vector<RingEvent>& events) {
    std::vector<int> kinds;
    for (const RingEvent& event : events) kinds.push_back(event.kind);
    return kinds;
  }
  static std::string state(const std::string& before, const std::string& after, const std::string& line) {
    return R"({"kind":"state","before":")" + before + R"(","after":")" + after + R"(","ring_size":3,"broken_line":)" +
           line + "}";
  }
};

TEST_F(Events, OfALinkNameTheOtherEnd) {
  const auto up = only(knee, R"({"kind":"link","is":"up","other":0,"what":"any words","time_ns":1500000000000000001})");
  EXPECT_EQ(up.kind, RingEvent::LINK_UP);
  EXPECT_EQ(up.node, "knee");
  EXPECT_EQ(up.other_node, "body");
  EXPECT_EQ(up.header.stamp, ros::Time(1500000000, 1));
  EXPECT_EQ(only(knee, R"({"kind":"link","is":"up","other":3})").other_node, "hip");
  const auto down = only(knee, R"({"kind":"link","is":"lost","other":null,"what":"input lost: silent"})");
  EXPECT_EQ(down.kind, RingEvent::LINK_DOWN);
  EXPECT_EQ(down.text, "input lost: silent");
}

TEST_F(Events, OfAPinAreAResetIfItIsWiredSo) {
  const auto reset = only(knee, R"({"kind":"pin","factor":0,"source":0,"what":"reset"})");
  EXPECT_EQ(reset.kind, RingEvent::RESET);
  EXPECT_EQ(reset.other_node, "body");
  const auto stop = only(knee, R"({"kind":"pin","factor":1,"source":3,"what":"stop"})");
  EXPECT_EQ(stop.kind, RingEvent::INTERRUPT);
  EXPECT_EQ(stop.value, 1);
  EXPECT_EQ(stop.other_node, "hip");
}

TEST_F(Events, OfACpuTellStateAndBoots) {
  const auto cpu = only(hip, R"({"kind":"cpu","state":"running","pid":7,"boots":2})");
  EXPECT_EQ(cpu.kind, RingEvent::CPU_STATE);
  EXPECT_EQ(cpu.text, "running");
  EXPECT_EQ(cpu.value, 2);
}

TEST_F(Events, OfABreakAreToldOnceAndItsCureByTheLast) {
  const std::string line = R"({"before":7,"behind":3})";
  const auto first = conversion.events_of(hip, state("up", "open_chain", line));
  ASSERT_THAT(first, SizeIs(2));
  EXPECT_EQ(first[0].text, "up -> open_chain");
  EXPECT_EQ(first[1].kind, RingEvent::LOCATED_FAULT);
  EXPECT_EQ(first[1].node, "knee");
  EXPECT_EQ(first[1].other_node, "hip");
  EXPECT_THAT(conversion.events_of(body, state("up", "open_chain", line)), SizeIs(1));
  EXPECT_THAT(conversion.events_of(hip, state("open_chain", "up", "null")), SizeIs(1));
  const auto last = conversion.events_of(body, state("open_chain", "up", "null"));
  ASSERT_THAT(last, SizeIs(2));
  EXPECT_EQ(last[1].kind, RingEvent::HEALED);
  EXPECT_EQ(last[1].node, "knee");
}

TEST_F(Events, OfANodeThatIsGoneDoNotHoldUpTheCure) {
  const std::string line = R"({"before":7,"behind":3})";
  conversion.events_of(hip, state("up", "open_chain", line));
  conversion.events_of(body, state("up", "open_chain", line));
  conversion.gone(hip);
  EXPECT_THAT(conversion.events_of(body, state("open_chain", "up", "null")), SizeIs(2));
}

TEST_F(Events, OfASecondBreakAreFoundInTheRowsAndCuredWithTheFirst) {
  conversion.events_of(hip, state("up", "open_chain", R"({"before":7,"behind":3})"));
  EXPECT_TRUE(conversion.is_open(hip));
  EXPECT_FALSE(conversion.is_open(body));
  const std::string second = R"({"state":"open_chain","broken_line":{"before":0,"behind":7}})";
  const auto all = conversion.events_of_row(hip, second);
  ASSERT_THAT(all, SizeIs(1));
  EXPECT_EQ(all[0].kind, RingEvent::LOCATED_FAULT);
  EXPECT_EQ(all[0].node, "body");
  EXPECT_EQ(all[0].other_node, "knee");
  EXPECT_THAT(conversion.events_of_row(hip, second), IsEmpty());
  EXPECT_THAT(kinds_of(conversion.events_of(hip, state("open_chain", "up", "null"))),
              ElementsAre(RingEvent::NODE_STATE, RingEvent::HEALED, RingEvent::HEALED));
}

TEST_F(Events, OfARingThatWasOpenBeforeItWasObservedAreItsFaultAndItsCure) {
  const auto all = conversion.events_of_row(hip, R"({"state":"open_chain","broken_line":{"before":7,"behind":3}})");
  ASSERT_THAT(kinds_of(all), ElementsAre(RingEvent::NODE_STATE, RingEvent::LOCATED_FAULT));
  EXPECT_EQ(all[0].text, "unknown -> open_chain");
  EXPECT_THAT(kinds_of(conversion.events_of(hip, state("open_chain", "up", "null"))),
              ElementsAre(RingEvent::NODE_STATE, RingEvent::HEALED));
}

TEST_F(Events, OfANodeThatIsRestartedTellThatItIsGoneAndHowItIsNow) {
  const std::string row = R"({"state":"up","ring_size":3,"cpu":{"state":"running","boots":1}})";
  conversion.events_of_row(knee, row);
  EXPECT_THAT(conversion.events_of_row(knee, row), IsEmpty()) << "all of it was told";
  const auto gone = conversion.gone(knee);
  EXPECT_EQ(gone.kind, RingEvent::NODE_STATE);
  EXPECT_EQ(gone.node, "knee");
  EXPECT_EQ(gone.text, "up -> down");
  const auto back = conversion.events_of_row(knee, row);
  ASSERT_THAT(kinds_of(back), ElementsAre(RingEvent::NODE_STATE, RingEvent::CPU_STATE));
  EXPECT_EQ(back[0].text, "down -> up");
  EXPECT_EQ(back[0].value, 3);
  EXPECT_EQ(back[1].text, "running");
  EXPECT_EQ(back[1].value, 1);
}

TEST_F(Events, ThatWereToldAreNotFoundInTheRowsAgain) {
  conversion.events_of(knee, state("joining", "up", "null"));
  conversion.events_of(knee, R"({"kind":"cpu","state":"running","boots":2})");
  EXPECT_THAT(conversion.events_of_row(knee, R"({"state":"up","cpu":{"state":"running","boots":2}})"), IsEmpty());
  EXPECT_THAT(conversion.events_of(knee, R"({"kind":"cpu","state":"running","boots":2})"), IsEmpty());
}

TEST_F(Events, AreNotMadeOfOtherMessages) {
  EXPECT_THAT(conversion.events_of(knee, "no json"), IsEmpty());
  EXPECT_THAT(conversion.events_of(knee, "[1]"), IsEmpty());
  EXPECT_THAT(conversion.events_of(knee, R"({"error":"no kind"})"), IsEmpty());
  EXPECT_THAT(conversion.events_of(knee, R"({"kind":"pin","factor":"x","source":null})"), SizeIs(1));
  for (const char* row : {"no json", "[1]", R"({"error":"no"})", R"({"state":1})"})
    EXPECT_THAT(conversion.events_of_row(knee, row), IsEmpty());
}

}  // namespace
}  // namespace limb_ring::bridge
