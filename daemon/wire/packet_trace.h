#pragma once

#include <optional>
#include <vector>

#include "wire/seen_packet.h"

namespace limb_ring::capture {

/// What happened to a packet at one node: its source first, and where it came home its source again.
struct Hop {
  wire::NodeId node{0};
  unsigned unseen = 0;  ///< nodes between the one before (or the source) and this one that the capture does not show
  std::optional<SeenPacket> in, out;  ///< nothing where it was not seen there
  /// On the node's line out between its coming in and its going out, in the order of that line.
  std::vector<SeenPacket> behind;
  /// INTPs that were on the line out inside of it.
  std::vector<SeenPacket> cut_by;

  /// From its first slice in to its first slice out; nothing where one of them is missing, or at home.
  std::optional<std::chrono::nanoseconds> waited() const;
};

/// How one try of a packet ended, as far as the capture shows.
enum class TripEnd : std::uint8_t {
  home,     ///< came back to its source, taken or not
  refused,  ///< came back with FBC 0
  damaged,  ///< came back with a bad CRC
  broken,   ///< came back without its end
  not_home  ///< was not seen coming back
};
const char* to_string(TripEnd end);

/// The path of one try of a packet, hop by hop, and the tries before it.
struct PacketTrace {
  wire::NodeId source{0};
  std::uint8_t code = 0;
  std::optional<SeenPacket::Trailer> trailer;
  std::uint16_t size = 0;
  std::vector<Hop> hops;
  TripEnd end = TripEnd::not_home;
  std::chrono::nanoseconds began{0}, ended{0};  ///< first slice of its first sighting, last slice of its last
  /// What was tried before it, the first one first: retries, and a packet of the same data sent again as new
  /// after a refusal. Without hops of their own.
  struct Earlier {
    std::uint8_t code = 0;
    TripEnd end = TripEnd::not_home;
    SeenPacket last_seen;
    std::chrono::nanoseconds began{0};
  };
  std::vector<Earlier> earlier;

  bool came_home() const { return end != TripEnd::not_home; }
  /// First slice of its first try.
  std::chrono::nanoseconds sent() const { return earlier.empty() ? began : earlier.front().began; }
  std::chrono::nanoseconds waited() const;  ///< at all nodes, as far as known
  /// From its first slice out of the node before to its first slice into that hop; nothing where one is missing. Of a
  /// living ring that is also the time in which the node's process was not running.
  std::optional<std::chrono::nanoseconds> on_line(std::size_t hop) const;
};

}  // namespace limb_ring::capture
