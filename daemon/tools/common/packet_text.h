#pragma once

#include <map>
#include <optional>
#include <string>

#include "limb_ring/captured_packet.h"
#include "wire/packet.h"
#include "wire/pcapng.h"

namespace limb_ring::app {

/// How `ringctl traffic show` shows times, as candump's -t.
enum class Stamps : char { absolute = 'a', delta = 'd', zero = 'z' };

struct PacketTextOptions {
  Stamps stamps = Stamps::absolute;
  bool decode = false;  ///< payloads in words where they are known
  bool ascii = false;   ///< behind bytes the same as characters, as candump -a
  bool colour = false;
};

/// Packets and events as lines of text, for people:
///
///   (time, s)  line  kind  source -> destination  hop  fbc  priority and channel  try/sequence  [bytes]  payload
class PacketText {
 public:
  PacketText(capture::RingNames names, PacketTextOptions options);

  std::string line(const CapturedPacket& packet);
  std::string line(const capture::CapturedEvent& event);

 private:
  std::string stamp(std::int64_t time_ns);
  std::string padded(const std::string& name, std::size_t width) const;
  std::string route(const CapturedPacket& packet) const;
  std::string fields(const CapturedPacket& packet) const;
  std::string payload(const CapturedPacket& packet) const;
  std::string bytes(wire::ByteView data) const;
  std::string remarks(const CapturedPacket& packet) const;

  capture::RingNames names_;
  PacketTextOptions options_;
  std::size_t widest_ = 0;
  std::optional<std::int64_t> reference_ns_;  ///< what times count from
};

/// One line of JSON, for programs.
std::string packet_json(const CapturedPacket& packet, const capture::RingNames& names);
std::string event_json(const capture::CapturedEvent& event, const capture::RingNames& names);

/// "control", "joint", or its number.
std::string channel_name(std::uint8_t channel);
/// The names of the channels that have one, by number: user, control, joint, topic.
const std::map<std::string, std::uint8_t>& named_channels();

/// What is in a data packet of that channel, in words; empty if nobody here knows.
std::string payload_words(std::uint8_t channel, wire::ByteView data, const capture::RingNames& names);

/// "01 02 ff"
std::string hex_words(wire::ByteView data);

/// The captured bytes of a packet, as the functions of wire/ take them; valid as long as `packet`.
inline wire::ByteView bytes_of(const CapturedPacket& packet) { return {packet.bytes.data(), packet.bytes.size()}; }
inline wire::PacketFields fields_of(const CapturedPacket& packet) { return {bytes_of(packet)}; }

}  // namespace limb_ring::app
