#include "config/quantity.h"

#include <gtest/gtest.h>

namespace limb_ring::config {
namespace {

using namespace std::chrono_literals;

TEST(Time, IsReadInEveryUnit) {
  EXPECT_EQ(parse_time("512ns"), 512ns);
  EXPECT_EQ(parse_time("50us"), 50us);
  EXPECT_EQ(parse_time("100ms"), 100ms);
  EXPECT_EQ(parse_time("2s"), 2s);
  EXPECT_EQ(parse_time("0s"), 0s);
}

TEST(Time, MayHaveAFractionAndOneBlank) {
  EXPECT_EQ(parse_time("0.5ms"), 500us);
  EXPECT_EQ(parse_time("1.5 s"), 1500ms);
  EXPECT_EQ(parse_time("1e3ms"), 1s);
  EXPECT_EQ(parse_time("2.5e-3s"), 2500us);
  EXPECT_EQ(parse_time("50µs"), 50us);
}

TEST(Time, WrittenAndReadAgainIsTheSame) {
  for (const auto time : {0ns, 1ns, 512ns, 1000ns, 1001ns, 50000ns, 100000000ns, 60000000000ns}) {
    EXPECT_EQ(parse_time(format_time(time)), time) << format_time(time);
  }
}

TEST(Time, IsWrittenInTheLargestWholeUnit) {
  EXPECT_EQ(format_time(60s), "60s");
  EXPECT_EQ(format_time(1500ms), "1500ms");
  EXPECT_EQ(format_time(512ns), "512ns");
  EXPECT_EQ(format_time(0ns), "0s");
  EXPECT_EQ(format_time(-1500ms), "-1500ms");
  EXPECT_EQ(format_time(std::chrono::nanoseconds::min()), "-9223372036854775808ns");
}

TEST(Time, IsWrittenForPeopleInTheLargestUnitThatIsNotAboveIt) {
  EXPECT_EQ(time_text(15433244us), "15.433244s");
  EXPECT_EQ(time_text(1050ns), "1.05us");
  EXPECT_EQ(time_text(20ms), "20ms");
  EXPECT_EQ(time_text(512ns), "512ns");
  EXPECT_EQ(time_text(0ns), "0s");
  EXPECT_EQ(time_text(-1500ms), "-1500ms");
  for (const auto time : {1000000001ns, 1001ns, 123456789ns}) EXPECT_EQ(parse_time(time_text(time)), time);
}

TEST(Time, RefusesEverythingElse) {
  for (const char* text : {"", "12", "12 parsec", "ms", "e3ms", "-5ms", "+5ms", "5  ms", "5ms ", ".", ".ms", "1.2.3s",
                           "5 MS", "99999999999s", "1,5s", "1e99s"})
    EXPECT_FALSE(parse_time(text)) << text;
}

TEST(Rate, IsReadInEveryUnitAndAsAPlainNumber) {
  EXPECT_EQ(parse_rate("1Gbit/s"), 1000000000u);
  EXPECT_EQ(parse_rate("10Mbit/s"), 10000000u);
  EXPECT_EQ(parse_rate("125kbit/s"), 125000u);
  EXPECT_EQ(parse_rate("9600 bit/s"), 9600u);
  EXPECT_EQ(parse_rate("115200"), 115200u);
  EXPECT_EQ(parse_rate("unlimited"), 0u);
}

TEST(Rate, IsReadAsPeopleWriteIt) {
  for (const char* text :
       {"1e9", "1G", "1g", "1Gbps", "1Gbit", "1 Gb/s", "1000M", "1000Mbits/s", "1E+9", "1.0e9 bit/s"})
    EXPECT_EQ(parse_rate(text), 1000000000u) << text;
  EXPECT_EQ(parse_rate("10MBit/s"), 10000000u);
  EXPECT_EQ(parse_rate("10mbit/s"), 10000000u);
}

TEST(Rate, InBytesIsRefusedInsteadOfBeingReadAsBits) {
  for (const char* text : {"10MB/s", "10 MB/s", "10MBps", "10B/s", "10MB", "10MByte/s"})
    EXPECT_FALSE(parse_rate(text)) << text;
}

TEST(Rate, WrittenAndReadAgainIsTheSame) {
  for (const std::uint64_t rate : {0u, 1u, 9600u, 125000u, 10000000u, 1000000000u, 2500000000u})
    EXPECT_EQ(parse_rate(format_rate(rate)), rate) << format_rate(rate);
}

TEST(Rate, RefusesEverythingElse) {
  for (const char* text : {"", "fast", "Gbit/s", "10M ", "10 ", "1GG", "-1", "1e", "1e9e", "99999999999Gbit/s"})
    EXPECT_FALSE(parse_rate(text)) << text;
}

TEST(Real, IsAPlainFiniteDecimalNumber) {
  EXPECT_EQ(parse_real("-0.5"), -0.5);
  EXPECT_EQ(parse_real("1e3"), 1000.0);
  for (const char* text : {"", "nan", "inf", "1e999", "0x10", "1,5", "1.5.2", "1 ", "12rad"})
    EXPECT_FALSE(parse_real(text)) << text;
}

TEST(Integer, MayHaveAnExponentOrAPrefix) {
  EXPECT_EQ(parse_integer("1e6"), 1000000);
  EXPECT_EQ(parse_integer("1.5E3"), 1500);
  EXPECT_EQ(parse_integer("64k"), 64000);
  EXPECT_EQ(parse_integer("1M"), 1000000);
  EXPECT_EQ(parse_integer("2G"), 2000000000);
  EXPECT_EQ(parse_integer("0.5k"), 500);
}

TEST(Integer, IsAPlainWholeNumber) {
  EXPECT_EQ(parse_integer("254"), 254);
  EXPECT_EQ(parse_integer("-3"), -3);
  EXPECT_EQ(parse_integer("+3"), 3);
  for (const char* text : {"", "+", "-", "+-3", "1.0", "0x10", "1e", "1e-3", "1.5", "1.0001k", "5m", "-1k", "12 ",
                           "1 kB", "1e30", "99999999999999999999"})
    EXPECT_FALSE(parse_integer(text)) << text;
}

}  // namespace
}  // namespace limb_ring::config
