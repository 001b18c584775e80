// What `ringctl ping` prints; how it sends is tested with real daemons (test/process/terminal_test.py).
#include "tools/ringctl/ping.h"

#include <gmock/gmock.h>

namespace limb_ring::ringctl {
namespace {

using std::chrono::microseconds;
using ::testing::HasSubstr;

PingOrder order() {
  PingOrder order;
  order.to = {10, "left_knee"};
  order.count = 4;
  return order;
}

Result ended(Outcome outcome, microseconds round_trip, unsigned tries = 1) {
  Result result;
  result.outcome = outcome;
  result.round_trip = round_trip;
  result.tries = tries;
  return result;
}

PingTotals totals() {
  PingTotals totals;
  totals.sent = 4;
  totals.took = std::chrono::milliseconds(1500);
  totals.add(ended(Outcome::delivered, microseconds(60)));
  totals.add(ended(Outcome::delivered, microseconds(80)));
  totals.add(ended(Outcome::no_such_node, microseconds(70)));
  return totals;
}

TEST(PingLine, IsAsPingPrintsIt) {
  EXPECT_EQ(ping_line(order(), 3, ended(Outcome::delivered, microseconds(61))),
            "512 bytes to 10 (left_knee): seq=3 time=61.0 us");
  EXPECT_THAT(ping_line(order(), 3, ended(Outcome::delivered, microseconds(61), 2)), HasSubstr("us tries=2"));
}

TEST(PingLine, SaysHowAPacketEndedThatWasNotDelivered) {
  EXPECT_EQ(ping_line(order(), 4, ended(Outcome::lost, microseconds(0), 5)),
            "10 (left_knee): seq=4 lost after 5 tries");
}

TEST(PingStatistics, CountEveryEndAndWhatHasNotEnded) {
  EXPECT_EQ(ping_text(order(), totals()),
            "--- left_knee ping statistics ---\n"
            "4 sent, 2 delivered, 1 no such node, 1 not ended, 1.500 s\n"
            "round trip min/p50/p99/max = 60.0/60.0/80.0/80.0 us\n");
}

TEST(PingStatistics, HaveNoRoundTripsIfNothingCameBack) {
  EXPECT_EQ(ping_text(order(), {}), "--- left_knee ping statistics ---\n0 sent, 0 delivered, 0.000 s\n");
}

TEST(PingStatistics, OfAVeryLongPingHavePercentilesOfItsLastPackets) {
  PingTotals totals;
  for (const int trip : {5, 900}) totals.add(ended(Outcome::delivered, microseconds(trip)));
  for (std::size_t i = 2; i < PingTotals::kKept; ++i) totals.add(ended(Outcome::delivered, microseconds(10)));
  EXPECT_THAT(ping_text(order(), totals), HasSubstr("min/p50/p99/max = 5.0/10.0/10.0/900.0 us\n"));
  for (std::size_t i = 0; i < PingTotals::kKept; ++i) totals.add(ended(Outcome::delivered, microseconds(20)));
  EXPECT_THAT(ping_text(order(), totals), HasSubstr("2000000 delivered"));
  EXPECT_THAT(ping_text(order(), totals), HasSubstr("= 5.0/20.0/20.0/900.0 us; p50 and p99 of the last 1000000\n"));
}

TEST(PingStatistics, AreTheSameInJson) {
  const nlohmann::json all = ping_json(order(), totals());
  EXPECT_EQ(all["delivered"], 2);
  EXPECT_EQ(all["other"], nlohmann::json({{"no such node", 1}}));
  EXPECT_EQ(all["round_trip_us"]["max"], 80.0);
  EXPECT_TRUE(ping_json(order(), {})["round_trip_us"]["p50"].is_null());
}

}  // namespace
}  // namespace limb_ring::ringctl
