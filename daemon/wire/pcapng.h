#pragma once

#include <cstdint>

/// The part of pcapng (IETF draft-ietf-opsawg-pcapng) that captures of a ring are made of: one Section
/// Header, an Interface Description for every line, Enhanced Packets. What the link type's pseudo-header
/// holds is in pseudo_header.h; docs/reference/captures.md describes all of it for people.
namespace limb_ring::capture::pcapng {

enum Block : std::uint32_t {
  kInterface = 1,
  kPacket = 2,  ///< obsolete, and of others alone
  kSimplePacket = 3,
  kEnhancedPacket = 6,
  kSectionHeader = 0x0A0D0D0A
};
constexpr std::uint32_t kByteOrderMagic = 0x1A2B3C4D;
constexpr std::uint16_t kLinkType = 147;          ///< LINKTYPE_USER0
constexpr std::uint32_t kMaxBlock = 1024 * 1024;  ///< bytes; larger ones are never ours, and not read

enum Option : std::uint16_t {
  kEnd = 0,
  kComment = 1,
  kApplication = 4,    ///< of a section header
  kInterfaceName = 2,  ///< if_name
  kResolution = 9,     ///< if_tsresol
  kPacketFlags = 2,    ///< epb_flags
  kDropCount = 4       ///< epb_dropcount
};
constexpr std::uint8_t kNanoseconds = 9;    ///< if_tsresol: 10^-9 s
constexpr std::uint8_t kPowerOfTwo = 0x80;  ///< with this bit the others say 2^-n s
constexpr std::uint8_t kMicroseconds = 6;   ///< where a file says nothing

constexpr std::uint32_t kInbound = 1, kOutbound = 2, kCrcError = 1u << 24;  ///< epb_flags

}  // namespace limb_ring::capture::pcapng
