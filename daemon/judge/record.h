#pragma once

#include <variant>

#include "core/archive.h"
#include "core/journal.h"

/// The records of a flight recorder: what a driver does to a core. (ours)
namespace limb_ring::recorder {

/// Slices that the driver took for that line.
struct Written {
  core::Line line;
  wire::ByteView slices;  ///< as put_slices() writes them

  template <class Archive>
  void archive(Archive& a) {
    a("line", line)("slices", slices);
  }
};

/// A packet that its CPU has taken. Its data came in with a slice, and is not recorded again.
struct Taken {
  core::Time at{};
  wire::NodeId source{}, destination{};
  wire::Priority priority{};
  wire::ChannelId channel{};
  std::uint16_t size = 0;
  std::uint32_t crc = 0;  ///< of its data

  Taken() = default;
  explicit Taken(const core::ReceivedPacket& packet)
      : at(packet.at),
        source(packet.source),
        destination(packet.destination),
        priority(packet.priority),
        channel(packet.channel),
        size(packet.size),
        crc(wire::crc32(packet.bytes())) {}

  template <class Archive>
  void archive(Archive& a) {
    a("at", at)("source", source)("destination", destination)("priority", priority)("channel", channel);
    a("size", size)("crc", crc);
  }
};

/// One call of a core: what went in, or what was taken out.
struct Record {
  core::Time at{};  ///< of the call, or of the one before where that one is not told the time
  std::variant<core::Input, Written, core::Event, Taken> what;
  bool data_left_out = false;  ///< it is a packet that came in, of which the data is not there: zeroes
};

/// Bytes of any value that has an archive(), for comparison.
template <class T>
std::vector<std::uint8_t> bytes_of(const T& what) {
  for (std::size_t room = 1024;; room *= 2) {
    std::vector<std::uint8_t> bytes(room);
    core::StateWriter writer(bytes.data(), bytes.size());
    const_cast<T&>(what).archive(writer);  // a writer changes nothing
    if (writer.failed()) continue;
    bytes.resize(writer.size());
    return bytes;
  }
}

}  // namespace limb_ring::recorder
