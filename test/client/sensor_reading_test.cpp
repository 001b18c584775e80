#include "limb_ring/payload/sensor_reading.h"

#include <cmath>

#include <gmock/gmock.h>

#include "client/hostile_bytes.h"

namespace limb_ring::payload {
namespace {

SensorReading imu() {
  SensorReading reading;
  reading.sequence = 0x0102;
  reading.stamp_ns = 5;
  reading.sensor = 3;
  reading.linear = {0, -1, 9.80665};
  reading.angular = {0.000001, 0, 0};
  return reading;
}

TEST(SensorReadingFormat, HasTheseBytes) {
  const auto packet = encode(imu());
  ASSERT_TRUE(packet);
  EXPECT_THAT(*packet, testing::ElementsAreArray(Bytes{3,    1,    1,    2,                 // imu, version, sequence
                                                       0,    0,    0,    0,    0, 0, 0, 5,  // stamp
                                                       3,    0,    0,    0,                 // sensor, flags, zero
                                                       0,    0,    0,    0,                 //
                                                       0xFF, 0xF0, 0xBD, 0xC0,              // -1,000,000
                                                       0x00, 0x95, 0xA3, 0x3A,              // 9,806,650
                                                       0,    0,    0,    1,                 //
                                                       0,    0,    0,    0,                 //
                                                       0,    0,    0,    0}));
}

TEST(SensorReadingFormat, ReadsBackBothKinds) {
  auto force = imu();
  force.kind = SensorReading::Kind::force;
  force.linear = {0.00001, 0, 21474.83647};
  for (const auto& written : {imu(), force}) {
    const auto read = decode_sensor_reading(view(*encode(written)));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->kind, written.kind);
    EXPECT_EQ(read->sequence, 0x0102);
    EXPECT_EQ(read->stamp_ns, 5);
    EXPECT_EQ(read->sensor, 3);
    EXPECT_FALSE(read->saturated);
    EXPECT_EQ(read->linear, written.linear);
  }
}

TEST(SensorReadingFormat, ClampsAndFlagsValuesOutOfRange) {
  auto wild = imu();
  wild.angular[1] = 3000;
  const auto read = decode_sensor_reading(view(*encode(wild)));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->saturated);
  EXPECT_EQ(read->angular[1], 2147.483647);
}

TEST(SensorReadingFormat, RefusesNotANumberAndNamesTheAxis) {
  auto wild = imu();
  wild.angular[1] = std::nan("");
  ASSERT_FALSE(encode(wild));
  EXPECT_EQ(encode(wild).error().item, 4U);
}

TEST(SensorReadingFormat, SurvivesHostileBytes) {
  expect_every_truncation_is_refused(*encode(imu()), decode_sensor_reading);
  expect_random_bytes_do_no_harm(3, decode_sensor_reading);
  expect_random_bytes_do_no_harm(4, decode_sensor_reading);
}

}  // namespace
}  // namespace limb_ring::payload
