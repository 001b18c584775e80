#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "wire/bytes.h"
#include "wire/checksum.h"

/// What DATP and INTP have in common: header, trailer, CRC. (paper, fields' use partly ours; protocol.md section 3)
///
///   Header  | Code | SOP | HOP | SID |    4 bytes
///   Data                                  1..512 bytes, DATP only
///   Trailer | EOP  | FBC | DID | last |   4 bytes; last is PRI in a DATP, INT in an INTP
///   CRC     32 bits, big-endian           over everything before it, as it is on that line

namespace limb_ring::wire {

/// A number of one byte with a type of its own, so that different kinds of numbers cannot be mixed up.
template <class What>
class Number {
 public:
  constexpr Number() = default;
  explicit constexpr Number(std::uint8_t value) : value_(value) {}
  constexpr operator std::uint8_t() const { return value_; }
  constexpr Number& operator++() {
    ++value_;
    return *this;
  }

 private:
  std::uint8_t value_ = 0;
};
using NodeId = Number<struct NodeNumber>;              ///< SID, DID: 0..254
using Sequence = Number<struct SequenceNumber>;        ///< 0..7
using Incarnation = Number<struct IncarnationNumber>;  ///< 0..3
using Priority = Number<struct PriorityNumber>;        ///< 0 (highest) to 3
using ChannelId = Number<struct ChannelNumber>;        ///< 0..63
using Factor = Number<struct FactorNumber>;            ///< 0..7, which pin an INTP pulls

constexpr std::uint8_t kPriorities = 4;
constexpr std::uint8_t kChannels = 64;

constexpr NodeId kBroadcast{0xFF};  ///< as DID: every node but the source
constexpr std::uint8_t kSop = 0xFB;
constexpr std::uint8_t kEop = 0xFD;
constexpr std::uint8_t kFbcUntaken = 0xFF;  ///< FBC as the source sends it: nobody took it yet
constexpr std::uint8_t kFbcMax = 254;       ///< the most free buffers a receiver may write

constexpr std::size_t kHeaderSize = 4;
constexpr std::size_t kTrailerSize = 4;
constexpr std::size_t kCrcSize = 4;
constexpr std::size_t kOverhead = kHeaderSize + kTrailerSize + kCrcSize;

/// Bytes in which the data of a DATP is passed on; INTPs are embedded at their boundaries. (paper, protocol.md
/// section 5.2)
constexpr std::size_t kWord = 4;
/// Bytes of a DATP that go on the line together, last: what is left of its data behind the whole words, trailer and
/// CRC. (ours, protocol.md section 5.2) @param size of the whole packet, bytes, at least kOverhead
constexpr std::size_t tail_size(std::size_t size) { return (size - kOverhead) % kWord + kTrailerSize + kCrcSize; }

/// Tries of a packet: the first and the retries. (ours, protocol.md section 4.3)
constexpr int kTries = 4;

/// Offsets of a packet's fields: in the header from its first byte, in the trailer back from the packet's end.
namespace field {
constexpr std::size_t kCode = 0, kSop = 1, kHop = 2, kSource = 3;
constexpr std::size_t kEopFromEnd = 8, kFbcFromEnd = 7, kDestinationFromEnd = 6, kLastFromEnd = 5;
}  // namespace field

/// Code: bits 7..6 incarnation of the source, 5 kind (0 DATP, 1 INTP), 4..3 try, 2..0 sequence. (ours)
struct Code {
  bool interrupt = false;
  std::uint8_t attempt = 0;  ///< 0 the first, below kTries
  Sequence sequence{};
  Incarnation incarnation{};  ///< incarnation_of() the source's boot number

  std::uint8_t byte() const {
    return static_cast<std::uint8_t>((incarnation & 3) << 6 | (interrupt ? 1 << 5 : 0) | (attempt & 3) << 3 |
                                     (sequence & 7));
  }
};
inline Code code_of(std::uint8_t byte) {
  return {(byte >> 5 & 1) != 0, static_cast<std::uint8_t>(byte >> 3 & 3), Sequence{static_cast<std::uint8_t>(byte & 7)},
          Incarnation{static_cast<std::uint8_t>(byte >> 6)}};
}
/// What a packet says of its source's boot number: its two low bits.
constexpr Incarnation incarnation_of(std::uint64_t boot) { return Incarnation{static_cast<std::uint8_t>(boot & 3)}; }

/// The boot number of a process that knows the last one of its node: the wall clock, or the next after the last one if
/// that is higher, as where the clock was set back; its incarnation follows that of the last one. (ours, protocol.md
/// section 4.8)
/// @param wall_ns since 1970
constexpr std::uint64_t next_boot(std::uint64_t last, std::uint64_t wall_ns) {
  const std::uint64_t next = last + 1;
  return wall_ns <= next ? next : (wall_ns | 3) + 1 + incarnation_of(next);
}

/// Fields of a packet as it lies in memory, from its first header byte to its last CRC byte.
/// @pre bytes.size >= kOverhead (header fields alone: >= kHeaderSize)
struct PacketFields {
  ByteView bytes;

  std::uint8_t code_byte() const { return bytes[field::kCode]; }
  Code code() const { return code_of(code_byte()); }
  std::uint8_t hop() const { return bytes[field::kHop]; }
  NodeId source() const { return NodeId{bytes[field::kSource]}; }
  ByteView data() const { return {bytes.data + kHeaderSize, bytes.size - kOverhead}; }
  std::uint8_t fbc() const { return bytes[bytes.size - field::kFbcFromEnd]; }
  NodeId destination() const { return NodeId{bytes[bytes.size - field::kDestinationFromEnd]}; }
  std::uint8_t last() const { return bytes[bytes.size - field::kLastFromEnd]; }
  std::uint32_t crc() const { return load_u32(bytes.data + bytes.size - kCrcSize); }
  bool crc_good() const { return crc32(bytes.first(bytes.size - kCrcSize)) == crc(); }
};

/// True if the four header bytes can begin a packet of that kind.
inline bool header_valid(ByteView header, bool interrupt) {
  return code_of(header[field::kCode]).interrupt == interrupt && header[field::kSop] == kSop &&
         header[field::kSource] != kBroadcast;
}
/// True if EOP is where the trailer of a packet of that size begins. @pre packet.size >= kOverhead
inline bool trailer_valid(ByteView packet) { return packet[packet.size - field::kEopFromEnd] == kEop; }

/// CRC of a packet after its HOP was XORed with `hop_delta` and its FBC with `fbc_delta`, from the
/// CRC it came with.
inline std::uint32_t carried_crc(std::uint32_t crc, std::size_t packet_size, std::uint8_t hop_delta,
                                 std::uint8_t fbc_delta) {
  // How many bytes that the CRC covers follow the field.
  const std::size_t after_hop = packet_size - kCrcSize - field::kHop - 1;
  constexpr std::size_t after_fbc = field::kFbcFromEnd - kCrcSize - 1;
  crc ^= crc32_change(hop_delta, after_hop);
  return fbc_delta == 0 ? crc : crc ^ crc32_change(fbc_delta, after_fbc);
}

/// Writes HOP and FBC into a packet and carries its CRC along.
inline void rewrite(std::uint8_t* packet, std::size_t size, std::uint8_t hop, std::uint8_t fbc) {
  std::uint8_t* crc = packet + size - kCrcSize;
  std::uint8_t& hop_field = packet[field::kHop];
  std::uint8_t& fbc_field = packet[size - field::kFbcFromEnd];
  store_u32(crc, carried_crc(load_u32(crc), size, hop_field ^ hop, fbc_field ^ fbc));
  hop_field = hop;
  fbc_field = fbc;
}

/// DATP, a data packet (paper; see packet.h for what the fields mean):
///
///   | Code | SOP | HOP | SID | Data 1..512 B | EOP | FBC | DID | PRI | CRC 4 B |
///
/// PRI: bits 1..0 priority, 0 the highest (paper); bits 7..2 channel (ours).
constexpr std::size_t kMaxPayload = 512;
constexpr std::size_t kMinDataPacketSize = kOverhead + 1;
constexpr std::size_t kMaxDataPacketSize = kOverhead + kMaxPayload;

/// Channels of the PRI field. (ours)
enum class Channel : std::uint8_t { user = 0, control = 1, joint = 2, fragment = 3 };

constexpr ChannelId id_of(Channel channel) { return ChannelId{static_cast<std::uint8_t>(channel)}; }

inline std::uint8_t pri_byte(Priority priority, ChannelId channel) {
  return static_cast<std::uint8_t>(channel << 2 | (priority & 3));
}
inline Priority priority_of(std::uint8_t pri) { return Priority{static_cast<std::uint8_t>(pri & 3)}; }
inline ChannelId channel_of(std::uint8_t pri) { return ChannelId{static_cast<std::uint8_t>(pri >> 2)}; }

/// True for a DATP on the network controllers' own channel.
inline bool is_control(const PacketFields& packet) { return channel_of(packet.last()) == id_of(Channel::control); }

/// INTP, an interrupt packet (paper):
///
///   | Code | SOP | HOP | SID | EOP | FBC | DID | INT | CRC 4 B |      12 bytes
///
/// INT: bits 2..0 the factor 0..7, the rest 0.
constexpr std::size_t kInterruptPacketSize = kOverhead;
constexpr std::uint8_t kFactors = 8;

inline Factor factor_of(std::uint8_t last) { return Factor{static_cast<std::uint8_t>(last & 7)}; }

using InterruptBytes = std::array<std::uint8_t, kInterruptPacketSize>;

/// How a send ended; every send has exactly one. (ours, protocol.md section 4.6) Core and client library both use
/// these values and words; limb_ring/host_port.h repeats the values, since a public header includes nothing of ours.
enum class Outcome : std::uint8_t { delivered, refused, no_such_node, lost, unconfirmed, rejected, cancelled };
constexpr std::size_t kOutcomes = static_cast<std::size_t>(Outcome::cancelled) + 1;

/// One or three words: "no such node".
constexpr const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::delivered:
      return "delivered";
    case Outcome::refused:
      return "refused";
    case Outcome::no_such_node:
      return "no such node";
    case Outcome::lost:
      return "lost";
    case Outcome::unconfirmed:
      return "unconfirmed";
    case Outcome::rejected:
      return "rejected";
    case Outcome::cancelled:
      return "cancelled";
  }
  return "unknown outcome";
}

}  // namespace limb_ring::wire
