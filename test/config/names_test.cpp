#include "config/ring_config.h"

#include <gtest/gtest.h>

#include "config/quantity.h"

namespace limb_ring::config {
namespace {

TEST(Names, OfRingsMayBecomeFolders) {
  for (const char* name : {"humanoid16", "a", "left-arm_2.1", "16"}) EXPECT_TRUE(is_ring_name(name)) << name;
  for (const char* name : {"", ".", "..", ".ring", "-ring", "a/b", "a b", "r\xC3\xB6hre"})
    EXPECT_FALSE(is_ring_name(name)) << name;
  EXPECT_TRUE(is_ring_name(std::string(32, 'r')));
  EXPECT_FALSE(is_ring_name(std::string(33, 'r')));
}

TEST(Names, OfNodesCannotBeTakenForIds) {
  for (const char* name : {"left_knee", "n0", "X"}) EXPECT_TRUE(is_node_name(name)) << name;
  for (const char* name : {"", "0", "12", "_a", "left-knee", "left.knee", "all"})
    EXPECT_FALSE(is_node_name(name)) << name;
}

TEST(Names, OfTopicsAreThoseOfRos) {
  for (const char* name : {"wrench", "/camera/image", "a/b_c/d1"}) EXPECT_TRUE(is_topic_name(name)) << name;
  for (const char* name : {"", "~state", "/", "a//b", "a/", "1a", "a b", "a-b", "a~b"})
    EXPECT_FALSE(is_topic_name(name)) << name;
}

TEST(PlainText, IsUtf8WithoutControlCharacters) {
  for (const char* text : {"", "a scenario", "r\xC3\xB6hre", "\xE2\x86\x92 \xF0\x9F\xA6\xBE", "<&\"'>"})
    EXPECT_TRUE(is_plain_text(text)) << text;
  // control characters of ASCII and Latin-1; a stray byte; one cut short; '/' in two bytes; half of a UTF-16 pair
  for (const char* text : {"a\nb", "\x1b[2J", "\x7f", "\xC2\x85", "\xFF", "\xC3", "\xC0\xAF", "\xED\xA0\x80"})
    EXPECT_FALSE(is_plain_text(text)) << text;
}

TEST(Digits, AreAsciiDigitsUpToANumberOfThem) {
  EXPECT_TRUE(are_digits("7"));
  EXPECT_TRUE(are_digits("0123456789"));
  EXPECT_TRUE(are_digits("255", 3));
  EXPECT_FALSE(are_digits("1000", 3));
  for (const char* text : {"", " 1", "1 ", "+1", "-1", "1.0", "0x1", "\xD9\xA1"})
    EXPECT_FALSE(are_digits(text)) << text;
}

TEST(PrintableText, IsOneLineAndOnlyTheBeginningOfALongText) {
  EXPECT_EQ(printable(std::string("a\nb\0c\x7f", 6)), "a?b?c?");
  EXPECT_EQ(printable(std::string(60, 'x')), std::string(60, 'x'));
  EXPECT_EQ(printable(std::string(61, 'x')), std::string(60, 'x') + "...");
  EXPECT_EQ(printable(std::string(59, 'x') + "\xC3\xB6"), std::string(59, 'x') + "...");
}

TEST(Names, CloseToAWordAreFound) {
  const std::vector<std::string> words{"send", "silence", "stall"};
  EXPECT_EQ(closest("sned", words), "send");
  EXPECT_EQ(closest("sendd", words), "send");
  EXPECT_EQ(closest("silense", words), "silence");
  EXPECT_EQ(closest("parsec", words), "");
  EXPECT_EQ(closest(std::string(100000, 's'), words), "");
}

}  // namespace
}  // namespace limb_ring::config
