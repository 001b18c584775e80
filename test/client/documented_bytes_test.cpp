// The examples of docs/reference/host_port.md are what the encoders write.
#include <fstream>
#include <string>

#include <gmock/gmock.h>

#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/fragmenter.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"

namespace limb_ring::payload {
namespace {

constexpr std::int64_t kStamp = 1700000000000000000;

/// Hexadecimal digits of the indented line behind the heading of a format.
std::string documented(const std::string& format) {
  std::ifstream page(LIMB_RING_FIRMWARE_PAGE);
  std::string line;
  while (std::getline(page, line) && line != "### " + format) {
  }
  while (std::getline(page, line) && line.rfind("    ", 0) != 0) {
  }
  std::string digits;
  for (const char letter : line)
    if (letter != ' ') digits += letter;
  return digits;
}

std::string digits_of(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

TEST(DocumentedBytes, OfAJointState) {
  JointState state;
  state.sequence = 7;
  state.stamp_ns = kStamp;
  state.mode.commanded = true;
  state.joints = {{0.5, -1, 2}};
  EXPECT_EQ(digits_of(*encode(state)), documented("Joint state"));
}

TEST(DocumentedBytes, OfAJointCommand) {
  JointCommand command;
  command.sequence = 7;
  command.stamp_ns = kStamp;
  command.valid_for_us = 100000;
  command.resume = true;
  command.joints = {{0.5, {}, {}}};
  EXPECT_EQ(digits_of(*encode(command)), documented("Joint command"));
}

TEST(DocumentedBytes, OfACommandSet) {
  CommandSet set;
  set.sequence = 7;
  set.stamp_ns = kStamp;
  set.valid_for_us = 100000;
  set.parts = {{1, {{0.5, {}, {}}}}, {2, {{-0.25, {}, {}}}}};
  EXPECT_EQ(digits_of(*encode(set)), documented("Command set"));
}

TEST(DocumentedBytes, OfASensorReading) {
  SensorReading reading;
  reading.sequence = 7;
  reading.stamp_ns = kStamp;
  reading.linear = {0, 0, 9.80665};
  EXPECT_EQ(digits_of(*encode(reading)), documented("Sensor reading"));
}

TEST(DocumentedBytes, OfAFragment) {
  Fragmenter fragmenter(4);
  ASSERT_TRUE(fragmenter.start(Fragment::Kind::data, {'h', 'o'}));
  fragmenter.next();
  ASSERT_TRUE(fragmenter.start(Fragment::Kind::data, {'h', 'i'}));
  EXPECT_EQ(digits_of(fragmenter.next()), documented("Fragment"));
}

}  // namespace
}  // namespace limb_ring::payload
