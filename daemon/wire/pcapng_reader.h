#pragma once

#include <istream>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "wire/pcapng_writer.h"

namespace limb_ring::capture {

/// This is no capture of a ring; what() names the file, where in it, and what is wrong.
struct CaptureFileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Something that happened at a node and is no packet.
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

}  // namespace limb_ring::capture
