#include "limb_ring/payload/sensor_reading.h"

#include <cmath>

#include "client/byte_stream.h"
#include "client/fixed_point.h"

namespace limb_ring::payload {
namespace {

using Kind = SensorReading::Kind;
constexpr std::size_t kSensorFlagsAt = 13;
constexpr std::uint8_t kSensorSaturated = 1;

double resolution(Kind kind) { return kind == Kind::imu ? kMicro : kTenMicro; }

/// @return the first axis that is NaN
std::optional<std::size_t> nan_axis(const SensorReading& reading) {
  for (std::size_t i = 0; i < 6; ++i)
    if (std::isnan(i < 3 ? reading.linear[i] : reading.angular[i - 3])) return i;
  return std::nullopt;
}

void put(ByteWriter& writer, const std::array<double, 3>& axes, Kind kind) {
  for (double value : axes) {
    const auto fixed = to_fixed(value, resolution(kind));
    writer.i32(fixed.steps);
    if (fixed.saturated) writer.at(kSensorFlagsAt) |= kSensorSaturated;
  }
}

void get(ByteReader& reader, std::array<double, 3>& axes, Kind kind) {
  for (double& value : axes) value = from_fixed(reader.i32(), resolution(kind));
}

}  // namespace

Encoded encode(const SensorReading& reading) {
  if (reading.stamp_ns < 0) return EncodeFailure{EncodeError::bad_field, 0};
  if (const auto axis = nan_axis(reading)) return EncodeFailure{EncodeError::not_a_number, *axis};
  ByteWriter writer;
  writer.head(static_cast<PacketType>(reading.kind));
  writer.u16(reading.sequence);
  writer.i64(reading.stamp_ns);
  writer.u8(reading.sensor);
  writer.u8(0);
  writer.u16(0);
  put(writer, reading.linear, reading.kind);
  put(writer, reading.angular, reading.kind);
  return writer.take();
}

Decoded<SensorReading> decode_sensor_reading(ByteView packet) {
  ByteReader reader(packet);
  SensorReading reading;
  reading.kind = is_type(packet, PacketType::force) ? Kind::force : Kind::imu;
  if (const auto wrong = reader.head(static_cast<PacketType>(reading.kind))) return *wrong;
  reading.sequence = reader.u16();
  reading.stamp_ns = reader.i64();
  reading.sensor = reader.u8();
  const auto flags = reader.u8();
  const auto zero = reader.u16();
  get(reader, reading.linear, reading.kind);
  get(reader, reading.angular, reading.kind);
  if (const auto wrong = reader.finish()) return *wrong;
  const bool unknown = (flags & ~kSensorSaturated) != 0 || zero != 0;
  if (unknown || reading.stamp_ns < 0) return DecodeError::bad_field;
  reading.saturated = flags != 0;
  return reading;
}

}  // namespace limb_ring::payload
