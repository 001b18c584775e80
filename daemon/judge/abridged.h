#pragma once

#include <cstdint>

#include "core/archive.h"
#include "judge/packed.h"
#include "wire/slice.h"

/// How packets are recorded whose data the core does not look at: header, trailer and CRC stand for the whole. (ours)
namespace limb_ring::recorder {

/// Added to the kind of a slice: its data is left out.
constexpr std::uint8_t kAbridged = 0x80;
/// Bytes of a packet that are left: its header, and its trailer with the CRC.
constexpr std::size_t kTail = wire::kTrailerSize + wire::kCrcSize;
constexpr std::size_t kAbridgedSize = wire::kHeaderSize + kTail;
/// Least size of a packet that is abridged, bytes: with less data it would not become much shorter.
constexpr std::size_t kLeastAbridged = kAbridgedSize + 16;

/// A whole DATP with data enough.
inline bool can_be_abridged(const wire::Slice& slice) {
  return slice.kind == wire::SliceKind::whole && slice.bytes.size >= kLeastAbridged;
}

/// Writes what is left of a packet: kAbridgedSize bytes.
void put_abridged(Packed to, wire::ByteView packet);

/// Writes framed slices, abridged where that can be:
///
///     | kind 8 | size 16 | bytes |        or        | kind 8 + kAbridged | size 16 | header 32 | trailer 32 | CRC 32 |
void put_slices(core::StateWriter& room, wire::ByteView framed_slices);

}  // namespace limb_ring::recorder
