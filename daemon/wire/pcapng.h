#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <istream>
#include <limits>
#include <map>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "limb_ring/captured_packet.h"
#include "wire/bytes.h"
#include "wire/packet_assembler.h"

/// The part of pcapng (IETF draft-ietf-opsawg-pcapng) that captures of a ring are made of: one Section
/// Header, an Interface Description for every line, Enhanced Packets. What the link type's pseudo-header
/// holds is in pcapng.h; docs/reference/captures.md describes all of it for people.

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
constexpr std::uint8_t kMicroseconds = 6;   ///< if a file says nothing

constexpr std::uint32_t kInbound = 1, kOutbound = 2, kCrcError = 1u << 24;  ///< epb_flags

}  // namespace limb_ring::capture::pcapng

namespace limb_ring::capture {

/// Whose packets a file holds.
struct RingNames {
  std::string ring;
  std::map<wire::NodeId, std::string> nodes;

  /// Its name, or its number if it has none.
  std::string of(std::uint8_t node) const;
  /// "left_hip -> left_knee"
  std::string line(std::uint8_t from, std::uint8_t to) const { return of(from) + " -> " + of(to); }
};

/// Writes packets as pcapng, which Wireshark reads: every line of the ring an interface, times in ns.
/// The stream's own state says whether writing has failed.
class PcapngWriter {
 public:
  PcapngWriter(std::ostream& out, RingNames names);

  /// @param time_ns since 1970, or of a virtual clock since its start
  /// @param lost_before packets that are missing before this one
  /// @param comment that Wireshark shows with it
  void packet(std::int64_t time_ns, const CaptureInfo& info, wire::ByteView bytes, std::uint32_t lost_before = 0,
              const std::string& comment = {});
  /// Something that happened at a node and is not a packet: a fault, a reset, a change of state.
  void event(std::int64_t time_ns, wire::NodeId node, const std::string& what);

 private:
  using Line = std::tuple<bool, wire::NodeId, wire::NodeId>;  ///< of events, from, to

  std::uint32_t interface_of(const Line& line, const std::string& name);

  std::ostream& out_;
  RingNames names_;
  std::map<Line, std::uint32_t> interfaces_;
};

/// This is not a capture of a ring; what() names the file, where in it, and what is wrong.
struct CaptureFileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Something that happened at a node and is not a packet.
struct CapturedEvent {
  std::int64_t time_ns = 0;
  wire::NodeId node{0};
  std::string what;
};

/// Reads what PcapngWriter has written, in either byte order and also after Wireshark's tools have
/// cut or merged it. A packet whose CRC is not as it was when it was captured comes out as one with a bad CRC.
/// Packets of other protocols, on other interfaces or in other sections, are counted and skipped.
class PcapngReader {
 public:
  using Record = std::variant<CapturedPacket, CapturedEvent>;

  /// @param name of the file, for errors. @throw CaptureFileError
  PcapngReader(std::istream& in, std::string name);

  /// The next packet (its steady_ns is 0) or event; nothing at the end. @throw CaptureFileError also at the end of a
  /// file that has nothing of ours
  std::optional<Record> next();
  /// As of the last section; here and in events, what is not plain ASCII is a question mark.
  const RingNames& names() const { return names_; }
  /// The file ends inside a block: whoever wrote it was killed.
  bool cut_short() const { return cut_short_; }
  /// What is wrong with the file as far as it was read, a sentence each: it is cut short, packets in it were changed
  /// or are not ours.
  std::vector<std::string> problems() const;

 private:
  struct Interface {
    bool ring;                ///< of our link type
    std::uint8_t resolution;  ///< as if_tsresol
  };

  bool read_block();
  void skip_block(std::uint32_t length);
  [[noreturn]] void fail_as_no_pcapng() const;
  bool read_bytes(std::size_t count);
  std::uint16_t u16(std::size_t at) const;
  std::uint32_t u32(std::size_t at) const;
  template <typename Visit>
  void each_option(std::size_t at, Visit visit) const;
  [[noreturn]] void fail(const std::string& what) const;

  void section_header();
  void interface();
  std::optional<Record> packet();
  /// A packet of a foreign section is ours only if it looks like one.
  bool is_ours(wire::ByteView bytes) const;
  void check_end() const;
  void check_crc(CapturedPacket& packet);
  std::int64_t time_ns(const Interface& interface) const;

  std::istream& in_;
  std::string name_;
  std::uint64_t offset_ = 0;  ///< of the present block
  bool big_endian_ = false;
  bool cut_short_ = false;
  bool ours_ = false;                ///< the section is of our writer
  bool any_ours_ = false;            ///< one of them is, or a packet was
  std::uint64_t changed_ = 0;        ///< packets
  std::uint64_t packets_ = 0;        ///< all
  std::uint64_t skipped_ = 0;        ///< those of other protocols
  std::vector<std::uint8_t> block_;  ///< type and length included
  std::vector<Interface> interfaces_;
  RingNames names_;
};

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

/// @pre bytes.size >= kPseudoHeaderSize. @return false if it is of another version
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

/// A capture file that stays open while it is read.
class CaptureFile {
 public:
  /// @param path "-": standard input @throw CaptureFileError if it cannot be read, or is not a capture
  explicit CaptureFile(const std::string& path);
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;

  PcapngReader& reader() { return reader_; }

 private:
  std::ifstream file_;
  PcapngReader reader_;
};

}  // namespace limb_ring::capture
