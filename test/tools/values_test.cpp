#include "tools/common/command_line.h"

#include <gmock/gmock.h>

namespace limb_ring::cli {
namespace {

/// What the option would hold; or what is wrong with it.
std::string taken(const CLI::Validator& validator, std::string text) {
  const std::string wrong = validator(text);
  return wrong.empty() ? text : wrong;
}

TEST(Whole, IsTakenAsPeopleWriteIt) {
  EXPECT_EQ(taken(whole(1, 1000000), "1e6"), "1000000");
  EXPECT_EQ(taken(whole(1, 1000000), "64k"), "64000");
  for (const char* text : {"0", "2M", "many", "1.5", ""})
    EXPECT_EQ(taken(whole(1, 1000000), text), "'" + std::string(text) + "' is not a whole number, 1 to 1000000");
}

TEST(Real, IsTakenAsPeopleWriteIt) {
  EXPECT_EQ(taken(real(0.001, 1000), "1e-3"), "0.001");
  EXPECT_EQ(taken(real(0.001, 1000), "0"), "'0' is not a number, 0.001 to 1000");
}

TEST(Seconds, MayHaveAUnit) {
  EXPECT_EQ(taken(seconds(0, 600), "5ms"), "0.005");
  EXPECT_EQ(taken(seconds(0, 600), "2"), "2");
  EXPECT_EQ(taken(seconds(0, 600), "100us"), "0.0001");
  EXPECT_EQ(taken(seconds(0.1, 600), "5ms"), "'5ms' is not a time, 100ms to 600s: 500ms, 2s, or a number of seconds");
  EXPECT_THAT(taken(seconds(1e-9, 1e6), "0"), testing::HasSubstr("1ns to 1000000s"));
}

TEST(Nanoseconds, AreKeptExactly) {
  const auto time = nanoseconds(std::chrono::nanoseconds(0), std::chrono::seconds(1000000));
  EXPECT_EQ(taken(time, "0.29"), "290000000");
  EXPECT_EQ(taken(time, "1234.567890123"), "1234567890123");
  EXPECT_EQ(taken(time, "999999.999999999"), "999999999999999");
  EXPECT_EQ(taken(time, "1.25s"), "1250000000");
  EXPECT_EQ(taken(time, "1e3"), "1000000000000");
  for (const char* text : {"-1", "1000000.000000001", "soon"})
    EXPECT_EQ(taken(time, text),
              "'" + std::string(text) + "' is not a time, 0s to 1000000s: 500ms, 2s, or a number of seconds");
}

TEST(Word, IsRefusedWithAGuess) {
  EXPECT_EQ(taken(one_of({"unix", "udp"}), "udp"), "udp");
  EXPECT_EQ(taken(one_of({"unix", "udp"}), "uinx"), "'uinx' is unknown, did you mean 'unix'? allowed: unix, udp");
  EXPECT_EQ(taken(one_of({"unix", "udp"}), "pigeons"), "'pigeons' is unknown; allowed: unix, udp");
}

TEST(Word, MayStandForAValueOfAnEnum) {
  enum class Fruit { apple, pear };
  const auto fruit = word_of<Fruit>({{"apple", Fruit::apple}, {"pear", Fruit::pear}});
  EXPECT_EQ(taken(fruit, "pear"), "1");
  EXPECT_EQ(taken(fruit, "peer"), "'peer' is unknown, did you mean 'pear'? allowed: apple, pear");
}

}  // namespace
}  // namespace limb_ring::cli
