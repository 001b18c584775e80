#include <gtest/gtest.h>

#include <stdexcept>

#include "bench/measurement.h"
#include "bench/suite.h"

namespace limb_ring::bench {
namespace {

Measurement of_p50(double p50) {
  Measurement measured;
  measured.round_trip_us.p50 = p50;
  return measured;
}

TEST(Cases, EachIsARowWithAllItsRoundsAndTheirReferences) {
  Cases cases;
  cases.add("shm", Sending::one, of_p50(20), 10);
  cases.add("shm", Sending::one, of_p50(90), 30);
  cases.add("shm", Sending::one, of_p50(40), 10);
  cases.add("shm", Sending::all, of_p50(50), 10);
  const auto rows = cases.rows(Pinning::free);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].what, "shm");
  EXPECT_EQ(rows[0].pinning, Pinning::free);
  EXPECT_EQ(rows[0].sending, Sending::one);
  EXPECT_EQ(rows[0].measured.round_trip_us.p50, 40);
  EXPECT_EQ(rows[0].reference_ratio, 3) << "the median of ratios, not the ratio of medians";
  EXPECT_EQ(rows[1].sending, Sending::all);
}

TEST(Cases, ARingWithAnAdditionIsComparedWithTheSameRingWithoutIt) {
  Cases cases;
  cases.add("watched", Sending::one, of_p50(30), 10);
  cases.add_without("watched", Sending::one, of_p50(20));
  cases.add("watched", Sending::one, of_p50(50), 10);
  cases.add_without("watched", Sending::one, of_p50(20));
  cases.add("unix", Sending::one, of_p50(20), 10);
  const auto rows = cases.rows(Pinning::free);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].addition_ratio, 0) << "unix is a ring with nothing in addition";
  EXPECT_EQ(rows[1].addition_ratio, 2);
}

TEST(Cases, ACaseThatWasNotMeasuredIsNotCompared) {
  Cases cases;
  EXPECT_THROW(cases.add_without("watched", Sending::one, of_p50(20)), std::out_of_range);
}

Measurement measured(double p50, double p99, double max, double rate, std::uint64_t packets = 1) {
  Measurement m;
  m.round_trip_us = {p50, p99, max};
  m.packets_per_second = rate;
  m.packets = packets;
  return m;
}

TEST(Median, IsTheMiddleOneOrBetweenTheTwoInTheMiddle) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_EQ(median({}), 0);
}

TEST(Measurement, OfSeveralSendersHasTheMedianOfMediansAndTheWorstOfTheRest) {
  const Measurement all = together({measured(10, 20, 30, 100), measured(12, 90, 95, 200), measured(11, 21, 400, 300)});
  EXPECT_EQ(all.round_trip_us.p50, 11);
  EXPECT_EQ(all.round_trip_us.p99, 90);
  EXPECT_EQ(all.round_trip_us.max, 400);
}

TEST(Measurement, OfSeveralSendersAddsUpTheirRatesAndCounts) {
  const Measurement all = together({measured(1, 1, 1, 100, 7), measured(1, 1, 1, 200, 8)});
  EXPECT_EQ(all.packets_per_second, 300);
  EXPECT_EQ(all.packets, 15u);
}

TEST(Measurement, OfSeveralRoundsHasTheirMediansAndTheWorstMaximum) {
  const Measurement all = of_rounds({measured(10, 20, 30, 100), measured(50, 90, 95, 10), measured(11, 21, 40, 90)});
  EXPECT_EQ(all.round_trip_us.p50, 11);
  EXPECT_EQ(all.round_trip_us.p99, 21);
  EXPECT_EQ(all.round_trip_us.max, 95);
  EXPECT_EQ(all.packets_per_second, 90);
  EXPECT_EQ(all.packets, 3u);
}

Row row(const std::string& what, std::uint64_t failed) {
  Row made;
  made.what = what;
  made.measured.packets = 100;
  made.measured.failed = failed;
  return made;
}

TEST(Report, CountsThePacketsThatFailedInAllRows) {
  Report report;
  EXPECT_EQ(to_json(report)["failed"], 0);
  report.rows = {row("reference", 0), row("shm", 2), row("udp", 3)};
  EXPECT_EQ(report.failed(), 5u);
  EXPECT_EQ(to_json(report)["failed"], 5);
  EXPECT_EQ(to_json(report)["udp"]["one_core"]["one_sender"]["failed"], 3);
}

TEST(Report, MarksTheRowsInWhichPacketsFailed) {
  Report report;
  report.rows = {row("reference", 0), row("shm", 2)};
  const std::string text = to_text(report);
  EXPECT_NE(text.find("2 FAILED"), std::string::npos) << text;
  EXPECT_EQ(text.find("0 FAILED"), std::string::npos) << text;
}

}  // namespace

}  // namespace limb_ring::bench
