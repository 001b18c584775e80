#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace limb_ring {

/// Where and how a packet was seen on a line of the ring. (ours)
struct CaptureInfo {
  bool input = true;       ///< seen at the input of node `to`; else at the output of node `from`
  std::uint8_t from = 0;   ///< the line: node id at its beginning
  std::uint8_t to = 0;     ///< ... and at its end
  bool crc_bad = false;    ///< came to its end, but the CRC does not fit
  bool aborted = false;    ///< an abort came instead of its end
  bool truncated = false;  ///< its end never came: the line was lost, or another packet began
  bool embedded = false;   ///< an interrupt packet inside a data packet, see carrier_*
  bool retry = false;      ///< not its first try
  bool own = false;        ///< of the node that saw it
  /// From its first slice to its last; 0 if it came in one. On a line with a data rate the last
  /// slice goes as its trailer begins.
  std::chrono::nanoseconds span{0};
  std::uint8_t carrier_source = 0;   ///< SID of the data packet that an embedded one was inside
  std::uint8_t carrier_code = 0;     ///< its Code: try and sequence
  std::uint16_t carrier_offset = 0;  ///< its bytes that were on the line before, header included
};

/// A packet seen on a line of this node (HostPort::observe() with "packets").
struct CapturedPacket {
  std::int64_t time_ns = 0;       ///< CLOCK_REALTIME of its last slice, ns since 1970
  std::int64_t steady_ns = 0;     ///< the same instant by CLOCK_MONOTONIC of that host
  std::uint32_t lost_before = 0;  ///< chosen packets left out before this one: read too slowly
  CaptureInfo info;
  /// Header to CRC as they were on that line: 13 to 524 bytes (DATP), 12 (INTP), or the part of it that came.
  std::vector<std::uint8_t> bytes;
};

/// Counts of the packets on the lines that are observed at this node, by this observer or another one:
/// seen = filtered + sampled_out + limited + lost + given. Comes when observing begins, every second in which packets
/// are given, and when it ends.
struct CaptureCounts {
  std::uint64_t seen = 0;
  std::uint64_t filtered = 0;     ///< not asked for
  std::uint64_t sampled_out = 0;  ///< asked for, but only every n-th
  std::uint64_t limited = 0;      ///< more than limit_per_s
  std::uint64_t lost = 0;         ///< the observer reads too slowly
  std::uint64_t given = 0;
};

}  // namespace limb_ring
