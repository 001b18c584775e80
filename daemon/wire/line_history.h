#pragma once

#include <vector>

#include "wire/seen_packet.h"

namespace limb_ring::capture {

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

}  // namespace limb_ring::capture
