#include "tools/capture_text/payload_words.h"

#include "limb_ring/payload/announcement.h"
#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/fragment.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"
#include "tools/common/text_table.h"
#include "wire/control_message.h"
#include "wire/data_packet.h"

namespace limb_ring::app {

namespace {

using capture::RingNames;
using std::to_string;
using wire::ByteView;

std::string words(const wire::Hello& hello) {
  return "hello, boot " + to_string(hello.boot) + (hello.remembers ? ", new numbers follow" : "");
}

std::string link_words(wire::LinkState state, const std::string& neighbour) {
  return wire::to_string(state) + (state == wire::LinkState::down ? "" : neighbour);
}

std::string words(const wire::Beacon& beacon, const RingNames& names) {
  std::string text = "beacon, boot " + to_string(beacon.boot);
  text += ", CPU " + std::string(wire::to_string(beacon.cpu_state)) + " (boot " + to_string(beacon.cpu_boots) +
          ", silent " + to_string(beacon.cpu_silent_ms) + " ms)";
  text += ", input " + link_words(beacon.input, " from " + names.of(beacon.input_from));
  text += ", output " + link_words(beacon.output, " to " + names.of(beacon.output_to));
  if (beacon.break_known) text += ", break " + names.line(beacon.break_before, beacon.break_behind);
  if (beacon.stop_latched) text += ", stop latched";
  if (beacon.latch.count != 0) text += ", clock latched by " + names.of(beacon.latch.source);
  return text;
}

std::string modes(const payload::JointState::Mode& mode) {
  const std::string words = payload::to_string(mode);
  return words.empty() ? words : " (" + words + ')';
}

std::string joint(std::size_t index) { return "; joint " + to_string(index); }

std::string words(const payload::JointState& state) {
  std::string text = "joint state " + to_string(state.sequence) + modes(state.mode);
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    const auto& values = state.joints[i];
    text += joint(i) + " at " + number(values.position, 4) + " rad, " + number(values.velocity, 4) + " rad/s, " +
            number(values.effort, 3) + " N m";
  }
  return text;
}

std::string words(const std::vector<payload::JointCommand::Joint>& joints) {
  std::string text;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto& values = joints[i];
    std::string wanted;
    if (values.position) wanted += " " + number(*values.position, 4) + " rad";
    if (values.velocity) wanted += " " + number(*values.velocity, 4) + " rad/s";
    if (values.effort) wanted += " " + number(*values.effort, 3) + " N m";
    if (!wanted.empty()) text += joint(i) + wanted;
  }
  return text;
}

std::string words(const payload::JointCommand& command) {
  return "joint command " + to_string(command.sequence) + ", valid for " + to_string(command.valid_for_us) + " us" +
         (command.resume ? ", resume" : "") + words(command.joints);
}

std::string words(const payload::CommandSet& set, const RingNames& names) {
  std::string text = "command set " + to_string(set.sequence) + ", valid for " + to_string(set.valid_for_us) + " us";
  for (const auto& part : set.parts) text += "; " + names.of(part.node) + words(part.joints);
  return text;
}

std::string triple(const std::array<double, 3>& values, const char* unit) {
  return number(values[0], 3) + " " + number(values[1], 3) + " " + number(values[2], 3) + " " + unit;
}

std::string words(const payload::SensorReading& reading) {
  const bool imu = reading.kind == payload::SensorReading::Kind::imu;
  return (imu ? "IMU " : "force ") + to_string(reading.sensor) + ", reading " + to_string(reading.sequence) + ": " +
         triple(reading.linear, imu ? "m/s2" : "N") + ", " + triple(reading.angular, imu ? "rad/s" : "N m");
}

std::string words(const payload::Fragment& fragment) {
  if (fragment.kind == payload::Fragment::Kind::announcement && fragment.count == 1)
    if (const auto topic = payload::decode_announcement(fragment.bytes))
      return "announces topic " + to_string(fragment.topic) + ": " + topic->name + " (" + topic->datatype + ")";
  return "piece " + to_string(fragment.index + 1) + " of " + to_string(fragment.count) + " of message " +
         to_string(fragment.message) + " (" + to_string(fragment.total) + " bytes) of topic " +
         to_string(fragment.topic);
}

std::string control_words(ByteView data, const RingNames& names) {
  if (const auto hello = wire::decode_hello(data)) return words(*hello);
  if (const auto beacon = wire::decode_beacon(data)) return words(*beacon, names);
  return {};
}

std::string joint_words(payload::ByteView data, const RingNames& names) {
  if (const auto state = payload::decode_joint_state(data)) return words(*state);
  if (const auto command = payload::decode_joint_command(data)) return words(*command);
  if (const auto set = payload::decode_command_set(data)) return words(*set, names);
  if (const auto reading = payload::decode_sensor_reading(data)) return words(*reading);
  return {};
}

}  // namespace

std::string payload_words(std::uint8_t channel, ByteView data, const RingNames& names) {
  switch (static_cast<wire::Channel>(channel)) {
    case wire::Channel::control:
      return control_words(data, names);
    case wire::Channel::joint:
      return joint_words({data.data, data.size}, names);
    case wire::Channel::fragment:
      if (const auto fragment = payload::decode_fragment({data.data, data.size})) return words(*fragment);
      return {};
    default:
      return {};
  }
}

std::string hex_words(ByteView data) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : data) {
    if (!text.empty()) text += ' ';
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace limb_ring::app
