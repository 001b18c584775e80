#include "tools/capture_text/packet_text.h"

#include <algorithm>
#include <cstdio>

#include "tools/capture_text/packet_bytes.h"
#include "tools/capture_text/payload_words.h"
#include "tools/common/colour.h"
#include "wire/data_packet.h"
#include "wire/filter.h"

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

}  // namespace limb_ring::app
