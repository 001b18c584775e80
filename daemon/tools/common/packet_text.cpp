#include "tools/common/packet_text.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "limb_ring/payload/announcement.h"
#include "limb_ring/payload/command_set.h"
#include "limb_ring/payload/fragment.h"
#include "limb_ring/payload/joint_command.h"
#include "limb_ring/payload/joint_state.h"
#include "limb_ring/payload/sensor_reading.h"
#include "tools/common/text_table.h"
#include "wire/control_message.h"
#include "wire/packet.h"
#include "wire/packet_filter.h"

namespace limb_ring::app {
namespace {

using capture::RingNames;
using std::to_string;

bool whole(const CapturedPacket& packet) { return capture::PacketView{{}, packet.info, bytes_of(packet)}.whole(); }
bool is_interrupt(const CapturedPacket& packet) { return fields_of(packet).code().interrupt; }
bool broken(const CaptureInfo& info) { return info.crc_bad || info.aborted || info.truncated; }

std::string right(unsigned value, int width) {
  char text[16];
  std::snprintf(text, sizeof text, "%*u", width, value);
  return text;
}

std::string destination_name(const RingNames& names, wire::NodeId destination) {
  return destination == wire::kBroadcast ? "all" : names.of(destination);
}

}  // namespace

std::string channel_name(std::uint8_t channel) {
  switch (static_cast<wire::Channel>(channel)) {
    case wire::Channel::user:
      return "user";
    case wire::Channel::control:
      return "control";
    case wire::Channel::joint:
      return "joint";
    case wire::Channel::fragment:
      return "topic";
  }
  return "ch " + to_string(channel);
}

const std::map<std::string, std::uint8_t>& named_channels() {
  static const auto kNames = [] {
    std::map<std::string, std::uint8_t> names;
    for (const wire::Channel channel :
         {wire::Channel::user, wire::Channel::control, wire::Channel::joint, wire::Channel::fragment})
      names[channel_name(static_cast<std::uint8_t>(channel))] = static_cast<std::uint8_t>(channel);
    return names;
  }();
  return kNames;
}

PacketText::PacketText(RingNames names, PacketTextOptions options) : names_(std::move(names)), options_(options) {
  for (const auto& [id, name] : names_.nodes) widest_ = std::max(widest_, name.size());
}

std::string PacketText::padded(const std::string& name, std::size_t width) const {
  return name + std::string(width > name.size() ? width - name.size() : 0, ' ');
}

std::string PacketText::stamp(std::int64_t time_ns) {
  std::int64_t shown = time_ns;
  if (options_.stamps != Stamps::absolute) shown -= reference_ns_.value_or(time_ns);
  if (options_.stamps == Stamps::delta || !reference_ns_) reference_ns_ = time_ns;
  const std::int64_t size = shown < 0 ? -shown : shown;
  char text[48];
  std::snprintf(text, sizeof text, "(%s%03lld.%09lld)", shown < 0 ? "-" : "", static_cast<long long>(size / 1000000000),
                static_cast<long long>(size % 1000000000));
  return text;
}

std::string PacketText::route(const CapturedPacket& packet) const {
  const std::string source = padded(names_.of(fields_of(packet).source()), widest_);
  const std::string to = whole(packet) ? destination_name(names_, fields_of(packet).destination()) : "?";
  return source + " -> " + padded(to, widest_);
}

std::string PacketText::fields(const CapturedPacket& packet) const {
  const wire::PacketFields fields = fields_of(packet);
  const bool all = whole(packet);
  const wire::Code code = fields.code();
  std::string last = "?";
  if (all && code.interrupt)
    last = "INT" + to_string(fields.last());
  else if (all)
    last = "p" + to_string(wire::priority_of(fields.last())) + " " + channel_name(wire::channel_of(fields.last()));
  const std::size_t size = all ? fields.data().size : packet.bytes.size();
  return "hop " + right(fields.hop(), 3) + "  fbc " + (all ? right(fields.fbc(), 3) : "  ?") + "  " + padded(last, 10) +
         "  " + to_string(code.attempt) + "/" + to_string(code.sequence) + "  [" +
         right(static_cast<unsigned>(size), 3) + "]";
}

std::string PacketText::payload(const CapturedPacket& packet) const {
  if (!whole(packet)) return bytes(bytes_of(packet));
  const wire::PacketFields fields = fields_of(packet);
  if (is_interrupt(packet)) return {};
  const bool decode = options_.decode && !packet.info.crc_bad;
  const std::string words =
      decode ? payload_words(wire::channel_of(fields.last()), fields.data(), names_) : std::string();
  return words.empty() ? bytes(fields.data()) : words;
}

std::string PacketText::bytes(wire::ByteView data) const {
  std::string text = hex_words(data);
  if (!options_.ascii) return text;
  text += "  '";
  for (const std::uint8_t byte : data) text += byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '.';
  return text + '\'';
}

std::string PacketText::remarks(const CapturedPacket& packet) const {
  const CaptureInfo& info = packet.info;
  std::string text;
  if (info.crc_bad) text += "  CRC bad";
  if (info.aborted) text += "  aborted";
  if (info.truncated) text += "  truncated";
  if (info.retry) text += "  retry";
  if (info.own && info.input) text += "  home";
  if (info.embedded) text += "  in DATP of " + names_.of(info.carrier_source) + " at " + to_string(info.carrier_offset);
  if (packet.lost_before != 0) text += "  (" + to_string(packet.lost_before) + " lost before)";
  return text;
}

std::string PacketText::line(const CapturedPacket& packet) {
  const std::string on = names_.line(packet.info.from, packet.info.to);
  std::string text = padded(on, 2 * widest_ + 4) + "  " + (is_interrupt(packet) ? "INTP" : "DATP") + "  " +
                     route(packet) + "  " + fields(packet);
  const std::string data = payload(packet);
  if (!data.empty()) text += "  " + data;
  text += remarks(packet);
  const std::string time = stamp(packet.time_ns) + "  ";
  if (!options_.colour) return time + text;
  const bool control = capture::kind_of({{}, packet.info, bytes_of(packet)}) == capture::Kind::control;
  const char* colour = broken(packet.info) ? kRed : is_interrupt(packet) ? kMagenta : control ? kDim : "";
  return time + colour + text + kPlain;
}

std::string PacketText::line(const capture::CapturedEvent& event) {
  return stamp(event.time_ns) + "  * " + names_.of(event.node) + ": " + event.what;
}

using nlohmann::json;

namespace {

void add_trailer(json& row, const wire::PacketFields& fields, const RingNames& names) {
  const std::uint8_t to = fields.destination();
  row["destination"] = to == wire::kBroadcast ? "all" : names.of(to);
  row["did"] = to;
  row["fbc"] = fields.fbc();
  if (fields.code().interrupt) {
    row["factor"] = fields.last();
    return;
  }
  row["priority"] = +wire::priority_of(fields.last());
  row["channel"] = +wire::channel_of(fields.last());
  row["data"] = hex_words(fields.data());
}

}  // namespace

std::string packet_json(const CapturedPacket& packet, const RingNames& names) {
  const wire::ByteView bytes = bytes_of(packet);
  const CaptureInfo& info = packet.info;
  const wire::PacketFields fields{bytes};
  const wire::Code code = fields.code();
  json row{{"time_ns", packet.time_ns},
           {"line", {names.of(info.from), names.of(info.to)}},
           {"at", info.input ? "in" : "out"},
           {"kind", code.interrupt ? "INTP" : "DATP"},
           {"source", names.of(fields.source())},
           {"sid", +fields.source()},
           {"hop", fields.hop()},
           {"try", code.attempt},
           {"sequence", +code.sequence},
           {"size", packet.bytes.size()},
           {"span_ns", info.span.count()},
           {"crc_bad", info.crc_bad},
           {"aborted", info.aborted},
           {"truncated", info.truncated},
           {"retry", info.retry},
           {"own", info.own},
           {"lost_before", packet.lost_before}};
  if (info.embedded) row["inside"] = {{"sid", info.carrier_source}, {"offset", info.carrier_offset}};
  if (capture::PacketView{{}, info, bytes}.whole()) add_trailer(row, fields, names);
  return row.dump();
}

std::string event_json(const capture::CapturedEvent& event, const RingNames& names) {
  return json{{"time_ns", event.time_ns}, {"node", names.of(event.node)}, {"event", event.what}}.dump();
}

namespace {

using wire::ByteView;

std::string words(const wire::Hello& hello) {
  return "hello, boot " + to_string(hello.boot) + (hello.remembers ? ", new numbers follow" : "");
}

std::string link_words(wire::LinkState state, const std::string& neighbour) {
  return wire::to_string(state) + (state == wire::LinkState::down ? "" : neighbour);
}

/// Of a field that is sent only if it says something.
std::string words_if_any(const char* title, bool is_so, const RingNames&) {
  return is_so ? ", " + std::string(title) : "";
}
std::string words_if_any(const char*, const wire::ClockLatch& latch, const RingNames& names) {
  return latch.count == 0 ? "" : ", clock latched by " + names.of(latch.source);
}

std::string words(const wire::Beacon& beacon, const RingNames& names) {
  std::string text = "beacon, boot " + to_string(beacon.boot);
  text += ", CPU " + std::string(wire::to_string(beacon.cpu_state)) + " (boot " + to_string(beacon.cpu_boots) +
          ", silent " + to_string(beacon.cpu_silent_ms) + " ms)";
  text += ", input " + link_words(beacon.input, " from " + names.of(beacon.input_from));
  text += ", output " + link_words(beacon.output, " to " + names.of(beacon.output_to));
  if (beacon.break_known) text += ", break " + names.line(beacon.break_before, beacon.break_behind);
  wire::Beacon::latched(
      [&](auto member, const wire::Field& field) { text += words_if_any(field.title, beacon.*member, names); });
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
