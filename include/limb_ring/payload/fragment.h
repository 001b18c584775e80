#pragma once

#include <cstdint>
#include <vector>

#include "limb_ring/payload/byte_view.h"
#include "limb_ring/payload/expected.h"
#include "limb_ring/payload/packet_type.h"

namespace limb_ring::payload {

/// A piece of a message too large for one packet: a ROS message of any type and size, or the
/// announcement that tells its type. On channel 3. (ours)
///
///    0      1         2       3      4         8       10      12      16         20
///   | type | version | topic | kind | message | index | count | total | checksum | bytes 0..492 |
///   | 8    | 8       | 8     | 8    | 32      | 16    | 16    | 32    | 32       |
///
///   count is what `total` bytes need in pieces of 492 (1 for none); every piece but the last is
///   full. The checksum is that of the whole message, the same in each of its pieces.
struct Fragment {
  enum class Kind : std::uint8_t { announcement = 0, data = 1 } kind = Kind::data;
  std::uint8_t topic = 0;     ///< chosen by the sender; means something with its node id only
  std::uint32_t message = 0;  ///< +1 for every message of this topic, announcements included
  std::uint16_t index = 0;    ///< from 0
  std::uint16_t count = 1;
  std::uint32_t total = 0;     ///< bytes of the whole message
  std::uint32_t checksum = 0;  ///< fnv1a of the whole message
  ByteView bytes;              ///< this piece; points into what was decoded
};

constexpr std::size_t kFragmentHeader = 20;
constexpr std::size_t kFragmentBytes = kMaxPacket - kFragmentHeader;  // 492
/// What 65,535 pieces hold: 32,243,220 bytes.
constexpr std::size_t kMaxMessage = std::size_t{0xFFFF} * kFragmentBytes;

/// 32-bit FNV-1a. Each packet has the ring's CRC already; this checksum finds wrongly reassembled pieces, and needs no
/// library.
std::uint32_t fnv1a(ByteView bytes);

/// Pieces that a message of `total` bytes needs, at least 1.
/// @pre total <= kMaxMessage
std::uint16_t fragment_count(std::size_t total);

/// @pre the fields fit together as decode_fragment() demands
std::vector<std::uint8_t> encode(const Fragment& fragment);
Decoded<Fragment> decode_fragment(ByteView packet);

}  // namespace limb_ring::payload
