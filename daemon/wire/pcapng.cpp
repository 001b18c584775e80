#include "wire/pcapng.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>
#include <sstream>

#include "wire/packet.h"

namespace limb_ring::capture {
namespace {

constexpr std::size_t kBlockHead = 8;    // type and length
constexpr std::size_t kPacketHead = 28;  // of an Enhanced Packet, up to its bytes
constexpr std::size_t kSectionOptions = 24;
constexpr std::size_t kInterfaceOptions = 16;
constexpr std::uint32_t kSmallestBlock = 12;
constexpr const char* kNoPcapng =
    "no pcapng file; 'ringctl traffic show -w FILE' and 'ring_sim run --capture FILE' write one";

/// What else people have, by its first bytes, and what is to be done about it.
struct OtherFormat {
  std::array<std::uint8_t, 4> magic;
  std::size_t size;  ///< bytes of it
  const char* what;
};
constexpr const char* kClassicPcap = "a classic pcap file; 'editcap -F pcapng FILE NEW' makes a pcapng file of it";
constexpr const char* kGzip = "compressed by gzip; 'gunzip FILE' unpacks it";
constexpr OtherFormat kOtherFormats[] = {
    {{0x1F, 0x8B}, 2, kGzip},
    {{0xA1, 0xB2, 0xC3, 0xD4}, 4, kClassicPcap},
    {{0xD4, 0xC3, 0xB2, 0xA1}, 4, kClassicPcap},
    {{0xA1, 0xB2, 0x3C, 0x4D}, 4, kClassicPcap},
    {{0x4D, 0x3C, 0xB2, 0xA1}, 4, kClassicPcap},
    {{0x28, 0xB5, 0x2F, 0xFD}, 4, "compressed by zstd; 'unzstd FILE' unpacks it"},
    {{0x04, 0x22, 0x4D, 0x18}, 4, "compressed by lz4; 'unlz4 FILE' unpacks it"},
};

/// ns since 1970 in 64 bits end in 2262; a year less leaves room for what is added to them.
constexpr std::uint64_t kLatest = 291ull * 365 * 24 * 3600 * 1'000'000'000;

std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

/// Whoever reads it may be a terminal or JSON: nothing but the characters of ASCII that can be seen.
std::string printable(std::string text) {
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

/// The whole number that this text is; nothing if it is none, or above 255.
std::optional<wire::NodeId> id_in(const std::string& text) {
  std::uint8_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return wire::NodeId{id};
}

/// Of so many steps. @return ns, rounded down; kLatest and one where it is later
std::uint64_t in_nanoseconds(std::uint64_t steps, std::uint8_t resolution) {
  __extension__ using Wide = unsigned __int128;
  constexpr Wide second = 1'000'000'000;
  Wide ns = steps * second;
  const unsigned n = resolution & ~pcapng::kPowerOfTwo;
  if ((resolution & pcapng::kPowerOfTwo) != 0) {
    ns >>= n;
  } else {
    for (unsigned digit = 0; digit < n && ns != 0; ++digit) ns /= 10;
  }
  return ns > kLatest ? kLatest + 1 : static_cast<std::uint64_t>(ns);
}

/// What the writer has said about the ring in the section's comment, as far as it is there.
RingNames names_in(const std::string& comment) {
  RingNames names;
  std::istringstream words(comment);
  std::string word;
  if (!(words >> word) || word != "ring") return names;
  words >> names.ring >> word;
  if (!names.ring.empty() && names.ring.back() == ';') names.ring.pop_back();
  while (words >> word) {
    const std::size_t equals = word.find('=');
    const auto id = id_in(word.substr(0, equals));
    if (equals == std::string::npos || !id) break;
    names.nodes[*id] = word.substr(equals + 1);
  }
  return names;
}

}  // namespace

PcapngReader::PcapngReader(std::istream& in, std::string name) : in_(in), name_(std::move(name)) {
  if (!read_block()) fail_as_no_pcapng();
  section_header();
}

void PcapngReader::fail_as_no_pcapng() const {
  for (const OtherFormat& other : kOtherFormats) {
    if (block_.size() >= other.size &&
        std::equal(other.magic.begin(), other.magic.begin() + other.size, block_.begin()))
      fail(other.what);
  }
  fail(kNoPcapng);
}

void PcapngReader::fail(const std::string& what) const {
  throw CaptureFileError(name_ + ": at byte " + std::to_string(offset_) + ": " + what);
}

std::uint16_t PcapngReader::u16(std::size_t at) const {
  const std::uint8_t* p = block_.data() + at;
  return big_endian_ ? wire::load_u16(p) : static_cast<std::uint16_t>(p[1] << 8 | p[0]);
}

std::uint32_t PcapngReader::u32(std::size_t at) const {
  const std::uint8_t* p = block_.data() + at;
  return big_endian_ ? wire::load_u32(p) : std::uint32_t{u16(at + 2)} << 16 | u16(at);
}

// Appends to the block. @return false at the end of the file
bool PcapngReader::read_bytes(std::size_t count) {
  const std::size_t before = block_.size();
  block_.resize(before + count);
  in_.read(reinterpret_cast<char*>(block_.data() + before), static_cast<std::streamsize>(count));
  if (static_cast<std::size_t>(in_.gcount()) == count) return true;
  cut_short_ = before > 0 || in_.gcount() > 0;
  return false;
}

bool PcapngReader::read_block() {
  offset_ += block_.size();
  block_.clear();
  if (!read_bytes(kSmallestBlock)) return false;
  if (offset_ == 0 && u32(0) != pcapng::kSectionHeader) fail_as_no_pcapng();
  // A section says its byte order just behind its length; its type reads alike in both.
  if (u32(0) == pcapng::kSectionHeader) {
    big_endian_ = wire::load_u32(block_.data() + kBlockHead) == pcapng::kByteOrderMagic;
    if (u32(kBlockHead) != pcapng::kByteOrderMagic) fail("a section without pcapng's byte-order magic");
  }
  const std::uint32_t length = u32(4);
  if (length < kSmallestBlock || length % 4 != 0)
    fail("a block of " + std::to_string(length) + " bytes; 12 and more in steps of 4 are possible");
  if (length <= pcapng::kMaxBlock) return read_bytes(length - kSmallestBlock);
  skip_block(length);
  return true;
}

// Its head is kept alone, with the type of a block that nobody needs.
void PcapngReader::skip_block(std::uint32_t length) {
  const std::uint32_t type = u32(0);
  const auto rest = static_cast<std::streamsize>(length - kSmallestBlock);
  in_.ignore(rest);
  if (type == pcapng::kSectionHeader || type == pcapng::kInterface || in_.gcount() != rest)
    fail("a block of " + std::to_string(length) + " bytes; " + std::to_string(pcapng::kMaxBlock) +
         " at most are possible");
  offset_ += static_cast<std::uint64_t>(rest);
  const bool is_packet = type == pcapng::kEnhancedPacket || type == pcapng::kSimplePacket || type == pcapng::kPacket;
  packets_ += is_packet ? 1 : 0;
  skipped_ += is_packet ? 1 : 0;
  std::fill_n(block_.begin(), sizeof type, std::uint8_t{0xFF});
}

template <typename Visit>
void PcapngReader::each_option(std::size_t at, Visit visit) const {
  const std::size_t end = block_.size() - 4;
  while (at + 4 <= end && u16(at) != pcapng::kEnd) {
    const std::size_t size = u16(at + 2);
    if (at + 4 + size > end) fail("an option that is longer than its block");
    visit(u16(at), at + 4, size);
    at += 4 + padded(size);
  }
}

void PcapngReader::section_header() {
  interfaces_.clear();
  ours_ = false;
  each_option(kSectionOptions, [this](std::uint16_t code, std::size_t at, std::size_t size) {
    if (code != pcapng::kComment) return;
    RingNames names = names_in(printable({block_.begin() + at, block_.begin() + at + size}));
    ours_ = !names.ring.empty();
    if (ours_) names_ = std::move(names);
  });
  any_ours_ |= ours_;
}

void PcapngReader::interface() {
  if (block_.size() < kInterfaceOptions + 4) fail("an interface that is too short");
  Interface read{u16(kBlockHead) == pcapng::kLinkType, pcapng::kMicroseconds};
  each_option(kInterfaceOptions, [&](std::uint16_t code, std::size_t at, std::size_t size) {
    if (code == pcapng::kResolution && size == 1) read.resolution = block_[at];
  });
  interfaces_.push_back(read);
}

std::int64_t PcapngReader::time_ns(const Interface& interface) const {
  const std::uint64_t steps = std::uint64_t{u32(kBlockHead + 4)} << 32 | u32(kBlockHead + 8);
  const std::uint64_t time = in_nanoseconds(steps, interface.resolution);
  if (time > kLatest) fail("a time after the year 2261");
  return static_cast<std::int64_t>(time);
}

// Whoever wrote the packet has noted whether its CRC was right. If it is not so now, the packet or the note was
// changed in the file.
void PcapngReader::check_crc(CapturedPacket& packet) {
  if (packet.info.aborted || packet.info.truncated) return;
  const wire::ByteView bytes{packet.bytes.data(), packet.bytes.size()};
  const bool good = bytes.size >= wire::kOverhead && wire::PacketFields{bytes}.crc_good();
  if (good != packet.info.crc_bad) return;
  packet.info.crc_bad = true;
  ++changed_;
}

// Our link type is everybody's: others use it for protocols of their own.
bool PcapngReader::is_ours(wire::ByteView bytes) const {
  if (ours_) return true;
  CaptureInfo info;
  if (bytes.size < kPseudoHeaderSize || !decode(bytes, info)) return false;
  if ((bytes[1] & kEventFlag) != 0) return true;
  return bytes.size >= kPseudoHeaderSize + wire::kHeaderSize &&
         bytes.size - kPseudoHeaderSize <= wire::kMaxDataPacketSize &&
         (info.crc_bad || bytes[kPseudoHeaderSize + 1] == wire::kSop);
}

std::optional<PcapngReader::Record> PcapngReader::packet() {
  if (block_.size() < kPacketHead + 4) fail("a packet that is too short");
  const std::uint32_t interface = u32(kBlockHead), size = u32(kBlockHead + 12);
  ++packets_;
  if (interface >= interfaces_.size()) fail("a packet of interface " + std::to_string(interface) + ", which is none");
  if (kPacketHead + padded(size) + 4 > block_.size()) fail("a packet that is longer than its block");
  const wire::ByteView bytes{block_.data() + kPacketHead, size};
  if (!interfaces_[interface].ring || !is_ours(bytes)) {
    ++skipped_;
    return std::nullopt;
  }
  any_ours_ = true;
  CapturedPacket packet;
  if (size < kPseudoHeaderSize || !decode(bytes, packet.info)) fail("a packet without limb_ring's pseudo-header");
  packet.time_ns = time_ns(interfaces_[interface]);
  std::string comment;
  each_option(kPacketHead + padded(size), [&](std::uint16_t code, std::size_t at, std::size_t length) {
    if (code == pcapng::kComment) comment.assign(block_.begin() + at, block_.begin() + at + length);
    if (code == pcapng::kDropCount && length == 8) packet.lost_before = u32(at + (big_endian_ ? 4 : 0));
  });
  if ((bytes[1] & kEventFlag) != 0)
    return CapturedEvent{packet.time_ns, wire::NodeId{packet.info.from}, printable(comment)};
  if (size < kPseudoHeaderSize + wire::kHeaderSize) fail("a packet without a header");
  if (size - kPseudoHeaderSize > wire::kMaxDataPacketSize)
    fail("a packet of " + std::to_string(size - kPseudoHeaderSize) + " bytes; " +
         std::to_string(wire::kMaxDataPacketSize) + " at most are possible");
  packet.bytes.assign(bytes.begin() + kPseudoHeaderSize, bytes.end());
  check_crc(packet);
  return packet;
}

std::vector<std::string> PcapngReader::problems() const {
  std::vector<std::string> all;
  if (cut_short_) all.push_back(name_ + " ends in the middle of a packet");
  if (changed_ == 1) all.push_back(name_ + ": 1 packet is not as it was captured");
  if (changed_ > 1) all.push_back(name_ + ": " + std::to_string(changed_) + " packets are not as they were captured");
  if (skipped_ > 0)
    all.push_back(name_ + ": skipped " + std::to_string(skipped_) + " of " + std::to_string(packets_) +
                  " packets, which are of another protocol");
  return all;
}

std::optional<PcapngReader::Record> PcapngReader::next() {
  while (read_block()) {
    switch (u32(0)) {
      case pcapng::kSectionHeader:
        section_header();
        break;
      case pcapng::kInterface:
        interface();
        break;
      case pcapng::kEnhancedPacket:
        if (auto record = packet()) return record;
        break;
      case pcapng::kSimplePacket:
      case pcapng::kPacket:
        ++packets_;
        ++skipped_;
        break;
      default:
        break;  // statistics, name resolution: nothing of ours
    }
  }
  check_end();
  return std::nullopt;
}

void PcapngReader::check_end() const {
  if (any_ours_) return;
  throw CaptureFileError(name_ + ": no packet of this protocol; skipped " + std::to_string(skipped_) + " of " +
                         std::to_string(packets_) +
                         " (limb_ring's captures have link type USER0 and its pseudo-header)");
}

namespace {

/// One block, little-endian; written as it goes out of scope.
class BlockWriter {
 public:
  BlockWriter(std::ostream& out, pcapng::Block type) : out_(out) {
    u32(type);
    u32(0);  // the length, known in the end
  }
  ~BlockWriter() {
    const std::size_t size = bytes_.size() + 4;
    for (int i = 0; i < 4; ++i) bytes_[4 + i] = static_cast<char>(size >> 8 * i);
    u32(static_cast<std::uint32_t>(size));
    out_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  }
  BlockWriter(const BlockWriter&) = delete;
  BlockWriter& operator=(const BlockWriter&) = delete;

  BlockWriter& u16(std::uint16_t value) {
    bytes_ += static_cast<char>(value & 0xFF);
    bytes_ += static_cast<char>(value >> 8);
    return *this;
  }
  BlockWriter& u32(std::uint32_t value) {
    return u16(static_cast<std::uint16_t>(value)).u16(static_cast<std::uint16_t>(value >> 16));
  }
  BlockWriter& run(wire::ByteView bytes) {
    bytes_.append(reinterpret_cast<const char*>(bytes.data), bytes.size);
    return *this;
  }
  BlockWriter& pad() {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    return *this;
  }
  BlockWriter& option(pcapng::Option code, const std::string& value) {
    u16(code).u16(static_cast<std::uint16_t>(value.size()));
    bytes_ += value;
    return pad();
  }
  BlockWriter& option_u32(pcapng::Option code, std::uint32_t value) { return u16(code).u16(4).u32(value); }
  BlockWriter& option_u64(pcapng::Option code, std::uint64_t value) {
    return u16(code).u16(8).u32(static_cast<std::uint32_t>(value)).u32(static_cast<std::uint32_t>(value >> 32));
  }
  BlockWriter& end_of_options() { return u32(pcapng::kEnd); }

 private:
  std::ostream& out_;
  std::string bytes_;
};

/// "ring humanoid16; nodes 0=body 1=waist"
std::string comment_of(const RingNames& names) {
  std::string text = "ring " + names.ring + "; nodes";
  for (const auto& [id, name] : names.nodes) text += " " + std::to_string(id) + "=" + name;
  return text;
}

/// Interface, time, lengths, pseudo-header and bytes of an Enhanced Packet; options may follow.
void put_packet(BlockWriter& block, std::uint32_t interface, std::int64_t time_ns, const PseudoHeader& header,
                wire::ByteView bytes) {
  const auto time = static_cast<std::uint64_t>(time_ns);
  const auto size = static_cast<std::uint32_t>(header.size() + bytes.size);
  block.u32(interface).u32(static_cast<std::uint32_t>(time >> 32)).u32(static_cast<std::uint32_t>(time));
  block.u32(size).u32(size).run({header.data(), header.size()}).run(bytes).pad();
}

}  // namespace

std::string RingNames::of(std::uint8_t node) const {
  const auto found = nodes.find(wire::NodeId{node});
  return found == nodes.end() ? std::to_string(node) : found->second;
}

PcapngWriter::PcapngWriter(std::ostream& out, RingNames names) : out_(out), names_(std::move(names)) {
  BlockWriter block(out_, pcapng::kSectionHeader);
  block.u32(pcapng::kByteOrderMagic).u16(1).u16(0);
  block.u32(0xFFFFFFFF).u32(0xFFFFFFFF);  // the section's length is not known
  block.option(pcapng::kComment, comment_of(names_)).option(pcapng::kApplication, "limb_ring").end_of_options();
}

std::uint32_t PcapngWriter::interface_of(const Line& line, const std::string& name) {
  const auto [place, added] = interfaces_.emplace(line, static_cast<std::uint32_t>(interfaces_.size()));
  if (added) {
    BlockWriter block(out_, pcapng::kInterface);
    block.u16(pcapng::kLinkType).u16(0).u32(0);  // no limit of a packet's length
    block.option(pcapng::kInterfaceName, name);
    block.option(pcapng::kResolution, std::string(1, static_cast<char>(pcapng::kNanoseconds))).end_of_options();
  }
  return place->second;
}

void PcapngWriter::packet(std::int64_t time_ns, const CaptureInfo& info, wire::ByteView bytes,
                          std::uint32_t lost_before, const std::string& comment) {
  const std::uint32_t interface =
      interface_of({false, wire::NodeId{info.from}, wire::NodeId{info.to}}, names_.line(info.from, info.to));
  BlockWriter block(out_, pcapng::kEnhancedPacket);
  put_packet(block, interface, time_ns, encode(info), bytes);
  const std::uint32_t direction = info.input ? pcapng::kInbound : pcapng::kOutbound;
  block.option_u32(pcapng::kPacketFlags, direction | (info.crc_bad ? pcapng::kCrcError : 0));
  if (lost_before > 0) block.option_u64(pcapng::kDropCount, lost_before);
  if (!comment.empty()) block.option(pcapng::kComment, comment);
  block.end_of_options();
}

void PcapngWriter::event(std::int64_t time_ns, wire::NodeId node, const std::string& what) {
  const std::uint32_t interface = interface_of({true, node, node}, names_.of(node) + " (events)");
  PseudoHeader header = encode(CaptureInfo{});
  header[1] = kEventFlag;
  header[2] = header[3] = node;
  BlockWriter block(out_, pcapng::kEnhancedPacket);
  put_packet(block, interface, time_ns, header, {});
  block.option(pcapng::kComment, what).end_of_options();
}

namespace {

// A folder can be opened like a file, but not read.
std::ifstream opened(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw CaptureFileError(path + ": cannot be read: it is a folder");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw CaptureFileError(path + ": cannot be read: " + std::strerror(errno));
  return file;
}

}  // namespace

CaptureFile::CaptureFile(const std::string& path)
    : file_(opened(path == "-" ? "/dev/stdin" : path)), reader_(file_, path == "-" ? "standard input" : path) {}

}  // namespace limb_ring::capture
