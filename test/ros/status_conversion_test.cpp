#include "ros_bridge/conversions.h"

#include <gmock/gmock.h>

#include "ros/small_robot.h"
#include "support/node_rows.h"

namespace limb_ring::bridge {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::ElementsAre;

status::NodeRow row(const std::string& members) { return test::node_row(json::parse(members)); }
status::Heard heard(const std::string& members) { return row(R"({"heard": [)" + members + "]}").heard.front(); }

class Status : public ::testing::Test {
 protected:
  const config::RingConfig ring = small_robot();
  NodeStatus status = unheard_node(ring.nodes.at(1));
};

TEST_F(Status, OfANodeNobodyHearsIsDown) {
  EXPECT_EQ(status.id, 7);
  EXPECT_EQ(status.name, "knee");
  EXPECT_EQ(status.state, "down");
  EXPECT_EQ(status.cpu_state, "unknown");
}

TEST_F(Status, TakesARowInSecondsAndWithItsCounters) {
  merge_status_row(row(R"({"state": "up", "pid": 4711,
      "cpu": {"pid": 4712, "boots": 2, "state": "running", "stop": {"latched": true}}, "ring_size": 16,
      "fold": {"second_input": "down"}, "round_trip_us": {"p50": 61.5, "p99": 90, "max": 120.25},
      "counters": {"lost": 3, "relayed_data": 12345678901}})"),
                   status);
  EXPECT_EQ(status.state, "up");
  EXPECT_EQ(status.pid, 4711);
  EXPECT_EQ(status.cpu_pid, 4712);
  EXPECT_EQ(status.cpu_boots, 2u);
  EXPECT_TRUE(status.stopped);
  EXPECT_EQ(status.ring_size, 16);
  EXPECT_EQ(status.second_input_state, "down");
  EXPECT_DOUBLE_EQ(status.round_trip_p50, 61.5e-6);
  EXPECT_DOUBLE_EQ(status.round_trip_p99, 90e-6);
  EXPECT_THAT(status.counter_names, ElementsAre("lost", "relayed_data"));
  EXPECT_THAT(status.counter_values, ElementsAre(3u, 12345678901u));
}

TEST_F(Status, OfACpuWhoseProcessIsStoppedIsHung) {
  merge_status_row(row(R"({"state": "up", "cpu": {"pid": 4712, "state": "running", "hung": true}})"), status);
  EXPECT_EQ(status.cpu_state, "hung");
  EXPECT_FALSE(status.stopped);
}

TEST_F(Status, OfANodeOnAnotherHostComesFromItsBeacons) {
  merge_beacon(heard(R"({"id": 7, "cpu_boots": 4, "cpu_state": "silent", "hop": 9,
                               "age_ms": 20, "stop_latched": true})"),
               100ms, status);
  EXPECT_TRUE(status.stopped);
  EXPECT_EQ(status.state, "up");
  EXPECT_EQ(status.cpu_state, "silent");
  EXPECT_EQ(status.cpu_boots, 4u);
  EXPECT_EQ(status.hop, 9);
  EXPECT_DOUBLE_EQ(status.beacon_age, 0.02);
}

TEST_F(Status, OfANodeThatIsHeardNoMoreStaysDown) {
  merge_beacon(heard(R"({"id": 7, "cpu_boots": 4, "cpu_state": "running", "hop": 9, "age_ms": 101})"), 100ms, status);
  EXPECT_EQ(status.state, "down");
  EXPECT_EQ(status.cpu_state, "unknown");
  EXPECT_DOUBLE_EQ(status.beacon_age, 0.101);
}

}  // namespace
}  // namespace limb_ring::bridge
