#include "bench/suite.h"

#include <gtest/gtest.h>

namespace limb_ring::bench {
namespace {

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
