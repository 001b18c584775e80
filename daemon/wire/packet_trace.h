#pragma once

#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "wire/packet_assembler.h"

namespace limb_ring::capture {

/// What happened to a packet at one node: its source first, and where it came home its source again.
struct Hop {
  wire::NodeId node{0};
  unsigned unseen = 0;  ///< nodes between the one before (or the source) and this one that the capture does not show
  std::optional<SeenPacket> in, out;  ///< nothing if it was not seen there
  /// On the node's line out between its coming in and its going out, in the order of that line.
  std::vector<SeenPacket> behind;
  /// INTPs that were on the line out inside of it.
  std::vector<SeenPacket> cut_by;

  /// From its first slice in to its first slice out; nothing if one of them is missing, or at home.
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
  /// From its first slice out of the node before to its first slice into that hop; nothing if one is missing. Of a
  /// living ring that is also the time in which the node's process was not running.
  std::optional<std::chrono::nanoseconds> on_line(std::size_t hop) const;
};

/// What has gone out of one node, in the order of its line.
class LineHistory {
 public:
  /// Packets are added in the order of `began`. @param packet must outlive this
  void add(const SeenPacket& packet);

  /// Packets that had the line while this one waited for it: the line was not free before this one came in, and they
  /// began before it went out. The carrier of an embedded INTP is listed only if there is nothing else: then the INTP
  /// waited for the header or a word of its carrier.
  std::vector<SeenPacket> in_front_of(const SeenPacket& in, const SeenPacket& out) const;
  /// INTPs inside that packet.
  std::vector<SeenPacket> inside(const SeenPacket& out) const;

 private:
  std::chrono::nanoseconds time_of(std::size_t bytes) const;
  std::chrono::nanoseconds free_after(const SeenPacket& packet) const;
  std::vector<const SeenPacket*>::const_iterator first_since(std::chrono::nanoseconds time) const;

  std::vector<const SeenPacket*> packets_;
  double byte_ns_ = -1;  ///< time of a byte on this line; 0 as fast as the host, negative: not known yet
  std::chrono::nanoseconds longest_{0};  ///< of one packet, first slice to last
};

/// Tells which try of a packet came before which: shown one try after the other, in their order. A retry
/// has the same sequence and the next try number, and follows before its source sends another packet of its
/// kind. What was refused is sent again for a second as a new packet: the same data to the same destination,
/// with the next sequence. (ours) Where a ring's `timeouts.refused` is longer, what comes after that second
/// counts as a new send.
class EarlierTries {
 public:
  /// One try of a packet.
  struct Try {
    SeenPacket seen;  ///< the sighting that shows most of it: with its trailer, if there is one
    std::chrono::nanoseconds began{0}, ended{0};  ///< first slice of its first sighting, last slice of its last
    TripEnd end = TripEnd::not_home;
  };
  /// The try before this one, as an index into the order of these calls; nothing if it is the first.
  std::optional<std::size_t> before(const Try& now);

 private:
  struct Known {
    Try tried;
    std::size_t index;
    std::chrono::nanoseconds refused_since;  ///< when it, or what it was sent again for, was refused first
  };
  using Unit = std::pair<wire::NodeId, bool>;                          // source, INTP
  using Route = std::tuple<wire::NodeId, wire::NodeId, std::uint8_t>;  // source, destination, PRI

  const Known* try_before(const Try& now) const;
  const Known* refused_before(const Try& now) const;
  void remember(const Known& known);

  std::size_t count_ = 0;
  std::map<Unit, std::map<std::uint8_t, Known>> by_try_;  ///< of the number each unit of a source sends now
  std::map<Route, Known> by_route_;                       ///< the last of each
};

}  // namespace limb_ring::capture
