#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "limb_ring/captured_packet.h"
#include "wire/bytes.h"

namespace limb_ring::capture {

/// What stands before a packet's bytes in a capture file (LINKTYPE_USER0) and on a host port (ours,
/// docs/reference/captures.md):
///
///   | version 1 | flags 8 | from 8 | to 8 | span 32, ns | carrier SID 8 | carrier Code 8 | offset 16 |
///
///   flags: bit 0 CRC bad, 1 aborted, 2 truncated, 3 embedded, 4 retry, 5 own, 6 seen at an input,
///          7 no packet: an event, said in the comment
constexpr std::size_t kPseudoHeaderSize = 12;
constexpr std::uint8_t kPseudoHeaderVersion = 1;
using PseudoHeader = std::array<std::uint8_t, kPseudoHeaderSize>;
constexpr std::uint8_t kEventFlag = 0x80;

/// The flags in the order of their bits, from bit 0.
constexpr std::array<bool CaptureInfo::*, 7> kFlagBits{
    &CaptureInfo::crc_bad, &CaptureInfo::aborted, &CaptureInfo::truncated, &CaptureInfo::embedded,
    &CaptureInfo::retry,   &CaptureInfo::own,     &CaptureInfo::input};

inline std::uint8_t flags_of(const CaptureInfo& info) {
  unsigned flags = 0;
  for (std::size_t bit = 0; bit < kFlagBits.size(); ++bit) flags |= (info.*kFlagBits[bit] ? 1u : 0u) << bit;
  return static_cast<std::uint8_t>(flags);
}

inline PseudoHeader encode(const CaptureInfo& info) {
  constexpr std::int64_t longest = std::numeric_limits<std::uint32_t>::max();
  PseudoHeader bytes{kPseudoHeaderVersion, flags_of(info), info.from, info.to};
  wire::store_u32(&bytes[4], static_cast<std::uint32_t>(std::clamp<std::int64_t>(info.span.count(), 0, longest)));
  bytes[8] = info.carrier_source;
  bytes[9] = info.carrier_code;
  wire::store_u16(&bytes[10], info.carrier_offset);
  return bytes;
}

/// @pre bytes.size >= kPseudoHeaderSize. @return false where it is of another version
inline bool decode(wire::ByteView bytes, CaptureInfo& info) {
  for (std::size_t bit = 0; bit < kFlagBits.size(); ++bit) info.*kFlagBits[bit] = (bytes[1] >> bit & 1) != 0;
  info.from = bytes[2];
  info.to = bytes[3];
  info.span = std::chrono::nanoseconds(wire::load_u32(bytes.data + 4));
  info.carrier_source = bytes[8];
  info.carrier_code = bytes[9];
  info.carrier_offset = wire::load_u16(bytes.data + 10);
  return bytes[0] == kPseudoHeaderVersion;
}

}  // namespace limb_ring::capture
